// SPDX-License-Identifier: MIT
#include "stages/emitter_parts.hpp"

#include <cmath>
#include <map>

#include "reference/emitter_parts.hpp"
#include "reference/gbuffer.hpp"
#include "support.hpp"

namespace manylight {
namespace {

constexpr unsigned width = 64, height = 40;
constexpr double metres = 0.1;  // of a pixel, in the plane of the lamps
constexpr float radiance = 50;

// Squares that face a camera at z = 10 in the plane z = 0, `side` pixels wide, the corner where
// `places` say, in pixels from the image's middle; `wall` stands between.
test::TestScene lamps(const std::vector<glm::vec3>& corners_and_sides, const Mesh* wall) {
    return test::make_scene(
        [&](GltfWriter& out) {
            Mesh mesh;
            for (const glm::vec3& l : corners_and_sides) {
                const float side = l.z * float(metres);
                mesh.add_quad({l.x * metres, l.y * metres, 0}, {side, 0, 0}, {0, side, 0});
            }
            out.add_mesh("lamps", mesh, out.add_emitter({radiance, 2 * radiance, 1}));
            if (wall) out.add_mesh("wall", *wall, out.add_diffuse({0, 0, 0}));
            out.add_camera("camera", {0, 0, 10}, {0, 0, 0},
                           2 * std::atan(height * float(metres) / 20), float(width) / height);
        },
        width, height);
}

double overlap(double from, double to, double pixel) {
    return std::max(std::min(to, pixel + 1) - std::max(from, pixel), 0.0);
}

// What each pixel sees of the lamps as they are stored, to the right of `edge`, in units of their
// radiance; y * width + x.
std::vector<double> seen_of(const Scene& scene, double edge) {
    std::vector<double> seen(std::size_t{width} * height, 0);
    for (std::size_t first = 0; first + 3 < scene.vertices.size(); first += 4) {
        Bounds lamp;
        for (std::size_t k = 0; k < 4; ++k) lamp.add(scene.vertices[first + k]);
        if (lamp.lower.z != 0) continue;
        const glm::dvec3 lower = glm::dvec3(lamp.lower) / metres,
                         upper = glm::dvec3(lamp.upper) / metres;
        for (unsigned y = 0; y < height; ++y)
            for (unsigned x = 0; x < width; ++x)
                seen[y * width + x] +=
                    overlap(std::max(lower.x, edge) + width / 2, upper.x + width / 2, x) *
                    overlap(height / 2 - upper.y, height / 2 - lower.y, y);
    }
    return seen;
}

RenderOptions two_samples(uint seed) {
    RenderOptions options;
    options.sampler = "uniform";
    options.light_samples = 1;
    options.spp = 2;
    options.seed = seed;
    return options;
}

}  // namespace

TEST(emitter_parts, agrees_with_the_reference) {
    FOR_EACH_DEVICE(device)
    for (const char* scene : {"kinds", "oriented"}) {
        SCOPED_TRACE(scene);
        test::expect_stage("emitter_parts", test::verifier(scene, device));
    }
}

// Lamps of a thousandth of a pixel to four pixels, wherever they lie among pixels.
TEST(emitter_parts, lamps_of_any_size_are_right_at_once) {
    std::vector<glm::vec3> squares;
    for (int i = 0; i < 28; ++i) {
        const float side = 0.001f * std::pow(4000.f, static_cast<float>(i) / 27);
        const float shift = 0.37f * static_cast<float>(i);
        squares.emplace_back(
            8.f * static_cast<float>(i % 7) - 29 + shift - std::floor(shift),
            9.f * static_cast<float>(i / 7) - 17 + 0.11f * static_cast<float>(i % 5), side);
    }
    const test::TestScene scene = lamps(squares, nullptr);
    const std::vector<double> seen = seen_of(scene.scene, -1e9);
    FOR_EACH_DEVICE(device) {
        const FrameResult result = test::render(device, scene, two_samples(3));
        for (std::size_t p = 0; p < seen.size(); ++p)
            ASSERT_NEAR(result.image.values[3 * p], radiance * seen[p],
                        radiance * (1e-3 * seen[p] + 1e-6))
                << "pixel " << p;
    }
}

// Lamps on both sides of an edge that hides a part of them.
TEST(emitter_parts, hidden_parts_are_unbiased) {
    const double edge = 0.3;  // pixels from the middle
    std::vector<glm::vec3> squares;
    for (int i = 0; i < 12; ++i)
        squares.emplace_back(edge - 0.1f * static_cast<float>(i), 3 * i - 18.2f,
                             0.05f + 0.1f * static_cast<float>(i));
    Mesh wall;
    const auto x = static_cast<float>(edge * metres / 2);  // half way to the camera
    wall.add_quad({x - 3, -3, 5}, {3, 0, 0}, {0, 6, 0});
    const test::TestScene scene = lamps(squares, &wall);
    const std::vector<double> seen = seen_of(scene.scene, edge);
    constexpr int seeds = 100;
    FOR_EACH_DEVICE(device) {
        std::vector<double> sum(seen.size()), squared(seen.size());
        for (uint seed = 0; seed < seeds; ++seed) {
            const FrameResult result = test::render(device, scene, two_samples(seed));
            for (std::size_t p = 0; p < seen.size(); ++p) {
                const double value = result.image.values[3 * p] / radiance;
                sum[p] += value;
                squared[p] += value * value;
            }
        }
        int varied = 0;
        for (std::size_t p = 0; p < seen.size(); ++p) {
            const double mean = sum[p] / seeds;
            const double variance = std::max(squared[p] / seeds - mean * mean, 0.0);
            varied += variance > 1e-9;
            EXPECT_NEAR(mean, seen[p], 5 * std::sqrt(variance / seeds) + 1e-4 * seen[p] + 1e-6)
                << "pixel " << p;
        }
        EXPECT_GT(varied, 6);
    }
}

// In a pixel that sees a long floor to the horizon, points are spread as the pixel's rays are: half
// of what it sees of it lies near. What lies beyond `depth` is hidden.
TEST(emitter_parts, points_are_even_in_the_pixel) {
    const float depth = 12;
    const test::TestScene scene = test::make_scene(
        [&](GltfWriter& out) {
            Mesh floor;
            floor.add_quad({-0.2f, 0, -1}, {0.4f, 0, 0}, {0, 0, -200});
            out.add_mesh("floor", floor, out.add_emitter({1, 1, 1}));
            Mesh plate;
            plate.add_quad({-1, 0.001f, -depth}, {2, 0, 0}, {0, 0, -300});
            out.add_mesh("plate", plate, out.add_diffuse({0, 0, 0}));
            out.add_camera("camera", {0, 1, 0}, {0, 1, -1}, 2 * std::atan(0.5f), 1);
        },
        8, 8);
    const Tiles tiles = all_tiles(8, 8, 32);
    const reference::Tracer tracer(scene.scene);
    constexpr int grid = 64, seeds = 200;
    FOR_EACH_DEVICE(device) {
        std::vector<double> mean(64, 0);
        for (uint seed = 0; seed < seeds; ++seed) {
            const FrameResult result = test::render(device, scene, two_samples(seed));
            for (std::size_t p = 0; p < 64; ++p) mean[p] += result.image.values[3 * p] / seeds;
        }
        int hidden = 0;
        for (uint pixel = 0; pixel < 64; ++pixel) {
            int shown = 0, on_floor = 0;
            for (int i = 0; i < grid * grid; ++i) {
                const reference::Ray ray = reference::primary_ray(
                    scene.camera, tiles,
                    {pixel % 8 + (i % grid + 0.5) / grid, pixel / 8 + (i / grid + 0.5) / grid});
                const auto hit = tracer.closest_hit(ray);
                shown += hit && hit->triangle < 2;
                on_floor += tracer.hit_of(0, ray) || tracer.hit_of(1, ray);
            }
            hidden += shown < on_floor && shown > 0;
            EXPECT_NEAR(mean[pixel], double(shown) / (grid * grid), 0.01) << pixel;
        }
        EXPECT_GT(hidden, 0);
    }
}

// Parts are what a grid of rays through each pixel meets of each triangle: of one that crosses the
// near plane, of some that reach beyond the image, of slivers, seen from both sides.
TEST(emitter_parts, are_what_rays_meet) {
    const test::TestScene scene = test::make_scene(
        [](GltfWriter& out) {
            Mesh mesh;
            mesh.add_triangle({-1, -0.5f, -2}, {0.2f, -0.4f, 4}, {-0.3f, 0.6f, 1});
            mesh.add_triangle({0.2f, 0.1f, 0}, {2, 0.3f, -1}, {0.3f, 0.9f, 0.4f});
            mesh.add_triangle({0.1f, -0.5f, 0}, {1.4f, -0.45f, 0}, {0.1f, -0.49f, 0});
            mesh.add_triangle({-0.42f, 0.7f, 0}, {-0.35f, 0.7f, 0}, {-0.4f, 0.77f, 0.1f});
            out.add_mesh("lamps", mesh, out.add_emitter({1, 1, 1}));
            out.add_camera("camera", {0, 0, 3}, {0, 0, 0}, 0.6f, 1.6f);
        },
        16, 10);
    Scene lit = scene.scene;
    for (Material& m : lit.materials) m.emission.w = 1;
    const Tiles tiles = all_tiles(16, 10, 32);
    const reference::Tracer tracer(lit);
    for (const bool orthographic : {false, true}) {
        Camera camera = scene.camera;
        camera.right.w = 0.3f;  // near plane
        camera.forward += 0.2f * camera.right;
        if (orthographic) {
            camera = scene.camera;
            camera.right.w = 0.3f;
            camera.forward.w = 1;
        }
        const EmitterParts found = find_emitter_parts(lit, camera, 16, 10);
        std::map<std::pair<uint, uint>, double> covered;  // pixel and triangle
        constexpr uint points = 32;
        for (uint number = 0; number < found.parts.size(); ++number)
            for (uint sample = 0; sample < points; ++sample) {
                const EmitterPart& part = found.parts[number];
                covered[{part.pixel, part.triangle}] +=
                    reference::part_light(lit, camera, tiles, part, number, 1, sample, 1).value.x /
                    points;
            }
        int partly = 0;
        constexpr int grid = 24;
        for (uint pixel = 0; pixel < 160; ++pixel)
            for (uint triangle = 0; triangle < lit.triangle_count(); ++triangle) {
                int hits = 0;
                for (int i = 0; i < grid * grid; ++i) {
                    const glm::dvec2 point(pixel % 16 + (i % grid + 0.5) / grid,
                                           pixel / 16 + (i / grid + 0.5) / grid);
                    const reference::Ray ray = reference::primary_ray(camera, tiles, point);
                    hits += tracer.hit_of(triangle, ray).has_value();
                }
                const double share = double(hits) / (grid * grid);
                const auto part = covered.find({pixel, triangle});
                partly += part != covered.end();
                if (part != covered.end())
                    EXPECT_NEAR(part->second, share, 0.03) << pixel << ", " << triangle;
                else
                    EXPECT_TRUE(share < 0.03 || share == 1)
                        << pixel << ", " << triangle << ": " << share;
            }
        EXPECT_GT(partly, 15);
    }
}

}  // namespace manylight

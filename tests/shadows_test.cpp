// SPDX-License-Identifier: MIT
// Traversal: packets and single rays, any hit and closest hit, against testing every triangle.
#include <cmath>
#include <random>

#include "bench/traversal.hpp"
#include "reference/gbuffer.hpp"
#include "reference/tiles.hpp"
#include "support.hpp"
#include "verify/scene_maker.hpp"

namespace manylight {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();

Scene scene_of(const std::vector<glm::vec3>& corners) {
    Scene scene;
    scene.file = "soup";
    scene.materials.push_back({});
    scene.materials[0].base_color = float4(0.5f, 0.5f, 0.5f, 0);
    scene.materials[0].roughness = 1;
    scene.vertices = corners;
    for (std::size_t i = 0; i < corners.size(); ++i)
        scene.indices.push_back(static_cast<std::uint32_t>(i));
    scene.triangle_materials.assign(corners.size() / 3, 0);
    return scene;
}

// Triangles of many sizes: slivers along the axes, needles, doubles, and some without area.
Scene hard_soup() {
    std::mt19937 engine(7);
    std::uniform_real_distribution<float> unit(-1, 1);
    std::vector<glm::vec3> corners;
    for (int t = 0; t < 700; ++t) {
        const glm::vec3 centre(unit(engine), unit(engine), unit(engine));
        const float size = std::pow(10.0f, -2 + 1.7f * std::abs(unit(engine)));
        glm::vec3 v[3];
        for (glm::vec3& p : v)
            p = centre + size * glm::vec3(unit(engine), unit(engine), unit(engine));
        if (t % 5 == 1) {  // an axis-aligned sliver, a hundredth as wide as long
            glm::vec3 along(0);
            glm::vec3 across(0);
            along[t % 3] = 1;
            across[(t + 1) % 3] = 0.01f;
            v[1] = v[0] + along;
            v[2] = v[0] + 0.3f * along + across;
        }
        if (t % 31 == 0) v[2] = v[1];
        for (int copy = 0; copy < (t % 23 == 0 ? 2 : 1); ++copy)
            corners.insert(corners.end(), v, v + 3);
    }
    return scene_of(corners);
}

void put(RayPacket& packet, std::size_t lane, glm::vec3 direction, float end) {
    packet.x[lane] = direction.x;
    packet.y[lane] = direction.y;
    packet.z[lane] = direction.z;
    packet.end[lane] = end;
}

// Packets of all sizes with directions of all kinds: random, close together, along axes, with zeros
// of either sign, without length.
std::vector<RayPacket> hard_packets(const Scene& scene) {
    std::mt19937 engine(11);
    std::uniform_real_distribution<float> unit(-1, 1);
    std::vector<RayPacket> packets;
    for (int i = 0; i < 400; ++i) {
        RayPacket packet{};
        packet.origin = 1.5f * glm::vec3(unit(engine), unit(engine), unit(engine));
        const std::size_t triangle = static_cast<std::size_t>(i) % scene.triangle_count();
        const glm::vec3* v = &scene.vertices[3 * triangle];
        if (i % 4 == 1) packet.origin = (v[0] + v[1] + v[2]) / 3.f;  // on a triangle
        if (i % 4 == 2) packet.origin = v[0] + 2.f * (v[1] - v[0]);  // in its plane
        const glm::vec3 aim(unit(engine), unit(engine), unit(engine));
        for (std::size_t lane = 0; lane < static_cast<std::size_t>(i % 17); ++lane) {
            glm::vec3 d(unit(engine), unit(engine), unit(engine));
            if (i % 3 == 1) d = aim + 0.02f * d;
            if (lane % 7 == 3) d = {0, lane % 2 ? 1.f : -1.f, -0.0f};
            if (lane % 7 == 5) d[i % 3] = lane % 2 ? 0.0f : -0.0f;
            if (lane % 7 == 6) d = glm::vec3(0);
            if (i % 4 == 2 && lane % 2 == 0) d = v[2] - packet.origin;
            put(packet, (lane * 5) % 16, d, lane % 3 == 0 ? infinity : 1);
        }
        packets.push_back(packet);
    }
    return packets;
}

DeviceTracer tracer_on(Device device, const Scene& scene, const WideBvh& bvh, bool portable) {
    const Camera camera{float4(1, 1, 2, 0), float4(0), float4(0), float4(0)};
    DeviceScene uploaded = upload_scene(device, scene, bvh, camera);
    if (portable) uploaded.traversal["PORTABLE_LANES"] = 1;
    return {device, uploaded};
}

// Whether something holds for a ray, or for one whose ends rounding may have moved, each by its own
// distance: what a ray in a triangle's plane, or along an edge, hits is decided by less.
template <class Holds>
bool holds_nearby(const reference::Ray& ray, double distance, const Holds& holds) {
    if (holds(ray)) return true;
    const auto corner = [](int bits) {
        return glm::dvec3(bits & 1 ? 1 : -1, bits & 2 ? 1 : -1, bits & 4 ? 1 : -1);
    };
    for (const double a : {1.0, 0.3, 0.1, 0.03, 0.01, 0.0})
        for (const double b : {1.0, 0.3, 0.1, 0.03, 0.01, 0.0})
            for (int k = 0; k < 64; ++k) {
                reference::Ray moved = ray;
                moved.origin += a * distance * corner(k);
                moved.direction += distance * (b * corner(k >> 3) - a * corner(k));
                if (holds(moved)) return true;
            }
    return false;
}

std::vector<float> trace(const Tracing& tracing, const RaySet& set) {
    tracing.prepare(set);
    tracing.run();
    return tracing.collect();
}

// The vertices and points of the edges of a closed mesh that is seen from within.
std::vector<glm::vec3> rims(const Scene& scene) {
    std::vector<glm::vec3> points;
    for (std::size_t i = 0; i < scene.indices.size(); ++i) {
        const glm::vec3 a = scene.vertices[scene.indices[i]];
        const glm::vec3 b = scene.vertices[scene.indices[i % 3 == 2 ? i - 2 : i + 1]];
        for (const float t : {0.f, 0.5f, 0.123f, 0.9f}) points.push_back(glm::mix(a, b, t));
    }
    return points;
}

// A crooked ball: triangles of many shapes, two poles where many meet.
Scene crooked_ball(float scale) {
    Scene scene = scene_of({});
    constexpr int rings = 13;
    constexpr int spokes = 22;
    for (int i = 0; i <= rings; ++i)
        for (int j = 0; j < spokes; ++j) {
            const float a = 3.14159265f * static_cast<float>(i) / rings;
            const float b = 6.28318531f * static_cast<float>(j) / spokes;
            glm::vec3 p(std::sin(a) * std::cos(b), std::cos(a), std::sin(a) * std::sin(b));
            if (i == 0 || i == rings) p = {0, i == 0 ? 1 : -1, 0};
            scene.vertices.push_back(scale * glm::vec3(1.3f, 0.8f, 1) * p);
        }
    const auto at = [](int i, int j) {
        return static_cast<std::uint32_t>(i * spokes + j % spokes);
    };
    for (int i = 0; i < rings; ++i)
        for (int j = 0; j < spokes; ++j) {
            if (i > 0)
                for (const auto k : {at(i, j), at(i, j + 1), at(i + 1, j)})
                    scene.indices.push_back(k);
            if (i < rings - 1)
                for (const auto k : {at(i + 1, j), at(i, j + 1), at(i + 1, j + 1)})
                    scene.indices.push_back(k);
        }
    scene.triangle_materials.assign(scene.indices.size() / 3, 0);
    return scene;
}

}  // namespace

TEST(shadows, hits_of_hard_sets_at_every_width) {
    const Scene scene = hard_soup();
    const reference::Tracer tracer(scene);
    FOR_EACH_DEVICE(device)
    for (const auto& [lanes, portable] :
         {std::pair(4u, false), {8u, false}, {16u, false}, {4u, true}, {8u, true}, {16u, true}})
        for (const bool any_hit : {true, false}) {
            const RaySet set{"hard", any_hit, false, hard_packets(scene)};
            const WideBvh bvh = build_wide_bvh(scene, lanes, lanes, 4);
            for (const Tracing& tracing :
                 tracer_on(device, scene, bvh, portable).tracings(any_hit)) {
                const std::vector<float> found = trace(tracing, set);
                int hits = 0;
                for (std::size_t i = 0; i < found.size(); ++i) {
                    const RayPacket& p = set.packets[i / 16];
                    if (!(p.end[i % 16] > 0)) {
                        EXPECT_EQ(found[i], infinity) << "an empty lane";
                        continue;
                    }
                    const reference::Ray ray{
                        p.origin, glm::dvec3(p.x[i % 16], p.y[i % 16], p.z[i % 16]), p.end[i % 16]};
                    const double shift = 2e-5 / std::max(glm::length(ray.direction), 1e-3);
                    const auto agrees = [&](const reference::Ray& r) {
                        const auto hit = tracer.closest_hit(r);
                        return hit.has_value() == (found[i] < infinity) &&
                               (any_hit || !hit ||
                                std::abs(hit->t - found[i]) < 1e-4 * hit->t + shift);
                    };
                    EXPECT_TRUE(holds_nearby(ray, 4e-6, agrees))
                        << tracing.name << ", width " << lanes << ", packet " << i / 16 << ", lane "
                        << i % 16 << ": " << found[i];
                    hits += found[i] < infinity;
                }
                EXPECT_GT(hits, 500);
            }
        }
}

// From within a closed mesh, towards its edges and vertices, every ray hits it.
TEST(shadows, closed_meshes_are_watertight) {
    FOR_EACH_DEVICE(device)
    for (const float scale : {1e-3f, 1.f, 1e5f}) {
        const Scene scene = crooked_ball(scale);
        const std::vector<glm::vec3> points = rims(scene);
        for (const bool any_hit : {true, false}) {
            RaySet set{"rims", any_hit, false, {}};
            for (const glm::vec3 eye : {glm::vec3(0), {0.3f, -0.2f, 0.1f}, {-0.9f, 0.3f, 0.2f}})
                for (std::size_t first = 0; first < points.size(); first += 16) {
                    RayPacket packet{};
                    packet.origin = scale * eye;
                    for (std::size_t lane = 0;
                         lane < std::min<std::size_t>(points.size() - first, 16); ++lane)
                        put(packet, lane, 1.5f * (points[first + lane] - packet.origin), 1);
                    set.packets.push_back(packet);
                }
            const Camera camera{float4(scale, scale, scale, 0), float4(0), float4(0), float4(0)};
            Device d = device;
            const unsigned lanes = d.form().bvh_width;
            const WideBvh bvh = build_wide_bvh(scene, lanes, lanes, reach_of(scene, camera));
            for (const Tracing& tracing :
                 DeviceTracer(d, upload_scene(d, scene, bvh, camera)).tracings(any_hit)) {
                const std::vector<float> found = trace(tracing, set);
                for (std::size_t i = 0; i < found.size(); ++i) {
                    if (!(set.packets[i / 16].end[i % 16] > 0)) continue;
                    ASSERT_LT(found[i], infinity)
                        << tracing.name << ", scale " << scale << ", ray " << i;
                }
            }
        }
    }
}

// A ball whose facets see a light is not in its own shadow, at any scale: all pixels that face the
// light are lit.
TEST(shadows, surfaces_do_not_shadow_themselves) {
    FOR_EACH_DEVICE(device)
    for (const float scale : {1e-3f, 0.1f, 1.f, 300.f, 1e5f}) {
        test::TestScene s = test::make_scene(
            [&](GltfWriter& out) {
                const Scene ball = crooked_ball(scale);
                out.add_mesh("ball", {ball.vertices, {}, ball.indices},
                             out.add_diffuse(glm::vec3(0.5f)));
                out.add_point(scale * glm::vec3(2, 3, 2.5f), scale * scale * glm::vec3(5));
                out.add_camera("front", scale * glm::vec3(0, 1, 4), {0, 0, 0}, 0.6f, 1);
            },
            96, 96);
        RenderOptions options;
        options.sampler = "exhaustive";
        options.spp = 1;
        const FrameResult result = test::render(device, s, options);
        const reference::Tracer tracer(s.scene);
        const Tiles tiles = all_tiles(96, 96, 32);
        int lit = 0;
        reference::for_each_pixel(tiles, [&](uint x, uint y, std::size_t) {
            const Surface surface =
                reference::gbuffer(s.scene, tracer, s.camera, tiles, x, y, false, 0, 0);
            if (surface.position.w < 0) return;
            const double expected = reference::unshadowed(surface, s.scene.materials[0], s.camera,
                                                          s.scene.lights[0], glm::dvec2(0))
                                        .value.g;
            if (expected < 1e-3) return;
            ++lit;
            EXPECT_NEAR(result.image.at(x, y)[1], expected, 0.02 * expected)
                << "scale " << scale << ", pixel " << x << ", " << y;
        });
        EXPECT_GT(lit, 1000);
    }
}

// A directional light that starts from a plane is not kept off by what is before that, as a
// camera's by the ceiling above it.
TEST(shadows, directional_light_from_a_plane) {
    for (const bool is_above : {false, true}) {
        SceneMaker maker;
        Mesh room;
        room.add_quad({-9, 0, 9}, {18, 0, 0}, {0, 0, -18});
        room.add_quad({-9, 2, -9}, {18, 0, 0}, {0, 0, 18});
        maker.add(room, maker.add(diffuse(glm::vec3(1))));
        const glm::vec3 place(0, is_above ? 3 : 1, 0);
        maker.add(directional_light_from(place, {0.3f, -1, 0}, glm::vec3(1)));
        test::TestScene s{maker.finish(), {}, 64, 48};
        s.camera = make_camera(look({0, 1.5, 0}, {0.01, 0, 0}, 0.6), s.width, s.height);
        for (const char* sampler : {"exhaustive", "adaptive", "ris", "power"}) {
            RenderOptions options;
            options.sampler = sampler;
            options.spp = 1;
            FOR_EACH_DEVICE(device) {
                Image image = test::render(device, s, options).image;
                unsigned lit = 0;
                for (unsigned y = 0; y < s.height; ++y)
                    for (unsigned x = 0; x < s.width; ++x) lit += image.at(x, y)[0] > 0 ? 1 : 0;
                EXPECT_EQ(lit, is_above ? 0u : 64u * 48) << sampler;
            }
        }
    }
}

// The light's edge on a ball of few triangles with vertex normals runs where that of a round ball
// does, and not along the triangles that turn from the light.
TEST(shadows, terminator_of_a_smooth_ball) {
    SceneMaker maker;
    maker.add(make_ball(glm::vec3(0), 1), maker.add(diffuse(glm::vec3(0.7f))));
    const glm::vec3 to_light = glm::normalize(glm::vec3(1, 0.3f, 0.2f));
    maker.add(directional_light(-to_light, glm::vec3(10)));
    test::TestScene s{maker.finish(), {}, 96, 72};
    s.camera = make_camera(look({0, 0.3, 4}, {0, 0, 0}, 0.6), s.width, s.height);
    RenderOptions options;
    options.sampler = "exhaustive";
    options.spp = 1;
    const Tiles tiles = all_tiles(s.width, s.height, 32);
    FOR_EACH_DEVICE(device) {
        const Image image = test::render(device, s, options).image;
        int lit = 0;
        int dark = 0;
        int wrong = 0;
        for (unsigned y = 0; y < s.height; ++y)
            for (unsigned x = 0; x < s.width; ++x) {
                const reference::Ray ray =
                    reference::primary_ray(s.camera, tiles, glm::dvec2(x, y) + 0.5);
                const double along = -glm::dot(ray.origin, ray.direction);
                const double inside = along * along - glm::dot(ray.origin, ray.origin) + 1;
                if (inside < 0.05) continue;  // near the outline
                const glm::dvec3 normal = ray.origin + (along - std::sqrt(inside)) * ray.direction;
                const double cosine = glm::dot(normal, glm::dvec3(to_light));
                if (std::abs(cosine) < 0.04) continue;
                const bool shines = image.at(x, y)[0] > 0;
                wrong += shines == (cosine > 0) ? 0 : 1;
                ++(cosine > 0 ? lit : dark);
            }
        EXPECT_GT(std::min(lit, dark), 500);
        EXPECT_LE(wrong, 5);
    }
}

}  // namespace manylight

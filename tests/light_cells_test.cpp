// SPDX-License-Identifier: MIT
// Which light, a cell of an area light, a point of an emissive triangle is on; and how probable it
// is to the kernels of stage reflections.
#include <cmath>
#include <random>

#include "stages/reflections.hpp"
#include "support.hpp"
#include "verify/sampler_checks.hpp"
#include "verify/stages.hpp"

namespace manylight {
namespace {

// Triangles and parallelograms of a few cells to the most along a side, in any direction.
Scene random_emitters() {
    std::mt19937 engine(5);
    std::uniform_real_distribution<float> unit(-1, 1);
    const auto direction = [&] {
        return glm::normalize(glm::vec3(unit(engine), unit(engine), unit(engine)));
    };
    Scene scene;
    for (int i = 0; i < 60; ++i) {
        const glm::vec3 corner = 5.f * direction();
        const glm::vec3 u = std::exp(2 * unit(engine)) * direction();
        const glm::vec3 v = std::exp(2 * unit(engine)) * direction();
        std::vector<glm::vec3> corners = {corner, corner + u, corner + v};
        if (i % 2 == 0) {  // the second triangle begins at any of its corners
            const glm::vec3 second[3] = {corner + u + v, corner + v, corner + u};
            for (int k = 0; k < 3; ++k) corners.push_back(second[(i / 2 + k) % 3]);
        }
        for (const glm::vec3& p : corners) {
            scene.indices.push_back(static_cast<std::uint32_t>(scene.vertices.size()));
            scene.vertices.push_back(p);
        }
        scene.triangle_materials.resize(scene.indices.size() / 3, 0);
    }
    Material material{};
    material.emission = float4(1, 1, 1, 0);
    material.alpha = 1;
    scene.materials = {material};
    return scene;
}

// The emission is black but for texels here and there, by each shape's own corner.
void add_texture(Scene& scene) {
    std::vector<glm::vec2>& coordinates = scene.coordinates.emplace_back();
    for (const glm::vec3& p : scene.vertices) coordinates.emplace_back(0.3f * p.x, 0.3f * p.y);
    Texture texture{};
    texture.width = texture.height = 4;
    texture.levels = 1;
    texture.format = TEXELS_SRGB;
    scene.textures = {texture};
    for (int i = 0; i < 16; ++i) scene.texels.push_back(i * i % 5 == 1 ? 0xffffffffu : 0xff000000u);
    const TextureMap none{float4(0), float4(0), NO_TEXTURE, 0, 0, 0};
    scene.maps.assign(MAP_KIND_COUNT, none);
    scene.maps[MAP_EMISSION] = {float4(1, 0, 0, 0), float4(0, 1, 0, 0), 0, 0, 1, 0};
}

void expect_cells(const Scene& scene, std::size_t triangles) {
    VerifyOptions options;
    options.width = options.height = 8;
    options.most_entries = 1 << 14;
    View view;
    view.to_world[3] = glm::dvec4(0, 0, 20, 1);
    FOR_EACH_DEVICE(device) {
        Verifier verifier(device, scene, make_camera(view, 8, 8), options);
        const Check check = check_stage(verifier, "cells").front();
        test::expect_pass(check);
        EXPECT_GE(check.telling, 64 * triangles);
    }
}

// A floor under lamps of many cells, and lights of other kinds before them.
const test::TestScene& lamps() {
    static const test::TestScene scene = test::make_scene(
        [](GltfWriter& out) {
            Mesh floor;
            floor.add_quad({-2, 0, 2}, {4, 0, 0}, {0, 0, -4});
            out.add_mesh("floor", floor, out.add_material({0.8f, 0.7f, 0.6f}, 1, 0.1f));
            Mesh lamps;
            lamps.add_quad({-1.5f, 1.5f, -1}, {1.4f, 0, 0}, {0, -0.1f, 0.9f});
            lamps.add_triangle({0.4f, 1, 0}, {0.9f, 1.2f, 1}, {1.9f, 1.1f, 0.2f});
            out.add_mesh("lamps", lamps, out.add_emitter({6, 5, 4}));
            for (int i = 0; i < 3; ++i) out.add_point({1.f - i, 0.8f, -0.4f}, {3, 4, 5});
            out.add_directional({0.2f, -1, 0.3f}, {2, 2, 1});
            out.add_camera("front", {0, 1.2f, 3}, {0, 0.2f, 0}, 0.9f, 1);
        },
        16, 16);
    return scene;
}

// Light samples that a sampler draws at every pixel of lamps(), and what the reference expects.
struct Drawing {
    Drawing(Device& device, const Sampler& sampler, const LightTree& tree, uint light_samples)
        : light_samples(light_samples),
          bvh(build_wide_bvh(lamps().scene, device.form().bvh_width, device.form().bvh_width, 10)),
          uploaded(upload_scene(device, lamps().scene, bvh, lamps().camera,
                                sampler.tree ? &tree : nullptr)),
          tiles(all_tiles(lamps().width, lamps().height, 16)),
          surfaces(device.allocate<Surface>(item_count(tiles))),
          places(lamps().scene.lights.size()) {
        for (uint i = 0; i < places.size(); ++i) places[sampler.tree ? tree.order[i] : i] = i;
        GBufferStage(device, uploaded).trace(tiles, {}, surfaces);
        ClusterOptions clusters;
        clusters.tile_size = 16;
        drawing = sampler.make({device, uploaded, lamps().scene.lights, tiles.count, 16,
                                lamps().width, light_samples, clusters, values_of(sampler)});
        drawing->prepare();
        drawing->begin(tiles, surfaces, 11, [](std::size_t) {});
        judge = checks_of(sampler).reference(*drawing, {lamps().scene, tree});
    }

    // How many are expected on a light at a point.
    [[nodiscard]] reference::ExpectedCount expected(const Surface& point, std::size_t item,
                                                    uint light) const {
        return *dynamic_cast<const reference::OneLight&>(*judge).expected_count(
            {lamps().scene, lamps().camera, point}, item, light, light_samples);
    }

    uint light_samples;
    WideBvh bvh;
    DeviceScene uploaded;
    Tiles tiles;
    Buffer<Surface> surfaces;
    std::vector<uint> places;  // [light] on the device
    std::unique_ptr<LightSampler> drawing;
    std::unique_ptr<reference::Sampler> judge;
};

// Where the density of a ray times the cell's solid angle is as large as the number of light
// samples that is expected on the cell, the ray's share is a half. Where none is, it is the whole.
void expect_shares(Device& device, ReflectionStage& stage, const Drawing& drawn, uint light) {
    const std::vector<Surface> points = drawn.surfaces.download();
    std::vector<Reflected> reflected(points.size());
    std::vector<double> expected(points.size(), -1);
    int judged = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (points[i].position.w < 0) continue;
        const reference::ExpectedCount counts = drawn.expected(points[i], i, light);
        double ratio = 0;
        for (const auto& [part, count] : counts.rounds) ratio += part * count;
        if (ratio == 0) ratio = 1;
        reflected[i] = {float4(1, 1, 1, ratio), float4(1), drawn.places[light], 0, 0, 0};
        if (counts.doubtful) continue;
        expected[i] = 0;
        for (const auto& [part, count] : counts.rounds)
            expected[i] += part * ratio * ratio / (ratio * ratio + count * count);
        ++judged;
    }
    EXPECT_GT(judged, 100);
    Buffer<float4> estimates = device.upload(std::vector<float4>(points.size(), float4(0)));
    stage.add_reflected(drawn.tiles, drawn.light_samples, drawn.surfaces, drawn.drawing->tables(),
                        device.upload(reflected), estimates);
    const std::vector<float4> found = estimates.download();
    for (std::size_t i = 0; i < found.size(); ++i)
        if (expected[i] >= 0) {
            EXPECT_NEAR(found[i].x, expected[i], 1e-4) << "item " << i << ", light " << light;
        }
}

}  // namespace

TEST(light_cells, cells_hold_the_points_that_find_them) {
    Scene scene = random_emitters();
    add_emitters(scene, 0);
    expect_cells(scene, 90);
}

TEST(light_cells, cells_without_light_are_none) {
    Scene scene = random_emitters();
    add_texture(scene);
    add_emitters(scene, 0);
    const std::vector<std::uint32_t>& lights = scene.light_cells.lights;
    const auto dark = static_cast<std::size_t>(std::ranges::count(lights, NO_LIGHT));
    EXPECT_EQ(lights.size() - dark, scene.lights.size());
    EXPECT_GT(dark, 500u);
    EXPECT_GT(scene.lights.size(), 500u);
    expect_cells(scene, 90);
}

// A light that is put before those of emitters moves them.
TEST(light_cells, name_lights_beside_a_headlight) {
    test::TestScene scene = lamps();
    const std::vector<Light> before = scene.scene.lights;
    add_headlight(scene.scene, find_view(scene.scene, ""));
    const LightCells& cells = scene.scene.light_cells;
    for (std::size_t i = 0; i < cells.lights.size(); ++i) {
        ASSERT_LT(cells.lights[i], scene.scene.lights.size());
        EXPECT_EQ(scene.scene.lights[cells.lights[i]].position,
                  before[lamps().scene.light_cells.lights[i]].position);
    }
    expect_cells(scene.scene, 3);
}

// light_probability() of every kernel file that has it, for every light at every pixel.
TEST(light_cells, probabilities_agree_with_the_reference) {
    const LightTree tree = build_light_tree(lamps().scene.lights);
    FOR_EACH_DEVICE(each) {
        Device device = each;
        for (const Sampler& sampler : all_samplers())
            for (const uint light_samples : {1u, 5u, 44u}) {
                if (sampler.closed_form.empty()) continue;
                SCOPED_TRACE(fmt::format("{}, {} light samples", sampler.name, light_samples));
                const Drawing drawn(device, sampler, tree, light_samples);
                ReflectionStage stage(device, drawn.uploaded, drawn.surfaces.size(),
                                      sampler.closed_form);
                for (uint light = 0; light < drawn.places.size(); ++light)
                    expect_shares(device, stage, drawn, light);
            }
    }
}

}  // namespace manylight

// SPDX-License-Identifier: MIT
#include <cmath>
#include <map>
#include <set>

#include "error.hpp"
#include "pipeline/aov.hpp"
#include "reference/gbuffer.hpp"
#include "reference/tiles.hpp"
#include "support.hpp"

namespace manylight {
namespace {

RenderOptions small_options(std::string_view sampler) {
    RenderOptions options;
    options.sampler = sampler;
    options.spp = 2;
    options.seed = 5;
    return options;
}

}  // namespace

// Where there are no lights, what shows by itself does, and pixel samples are counted.
TEST(frame, surfaces_show_without_lights) {
    test::TestScene scene = test::make_scene([](GltfWriter& out) {
        Mesh wall;
        wall.add_quad({-9, -9, 0}, {18, 0, 0}, {0, 18, 0});
        out.add_mesh("wall", wall, out.add_diffuse({1, 1, 1}));
        out.add_camera("camera", {0, 0, 3}, {0, 0, 0}, 0.8f, 1.6f);
    });
    Material& material = scene.scene.materials[scene.scene.triangle_materials[0]];
    material.emission = float4(0.5f, 0.3f, 0.8f, 1);
    material.unlit = 1;
    FOR_EACH_DEVICE(device)
    for (const char* sampler : {"adaptive", "contribution-defensive", "exhaustive"}) {
        const FrameResult result = test::render(device, scene, small_options(sampler));
        EXPECT_EQ(result.spp, 2) << sampler;
        for (std::size_t i = 0; i < result.image.values.size(); ++i)
            ASSERT_NEAR(result.image.values[i], material.emission[static_cast<int>(i % 3)], 1e-6)
                << sampler;
    }
}

TEST(frame, same_seed_gives_the_same_bits) {
    FOR_EACH_DEVICE(device)
    for (const Sampler& sampler : all_samplers()) {
        const test::TestScene& scene = test::scene_named("kinds");
        const FrameResult a = test::render(device, scene, small_options(sampler.name));
        const FrameResult b = test::render(device, scene, small_options(sampler.name));
        EXPECT_EQ(a.image.values, b.image.values) << sampler.name;
        RenderOptions other = small_options(sampler.name);
        other.seed = 6;
        EXPECT_NE(a.image.values, test::render(device, scene, other).image.values) << sampler.name;
    }
}

// No buffer of a batch is larger than the device allows.
TEST(frame, batches_fit_the_devices_buffers) {
    const test::TestScene& scene = test::scene_named("many");
    RenderOptions options = small_options("adaptive");
    options.width = 640;
    options.height = 640;
    const WideBvh bvh = build_wide_bvh(scene.scene, 8, 8, 10);
    DeviceInfo info = test::devices().front().info();
    const Plan whole = make_plan(info, scene.scene, bvh, options);
    EXPECT_EQ(whole.batches, 1u);
    EXPECT_EQ(whole.tiles_per_batch, 400u);
    info.max_allocation = 8'000'000;
    const Plan parts = make_plan(info, scene.scene, bvh, options);
    EXPECT_LE(parts.tiles_per_batch * 256 * CELLS_PER_TILE * sizeof(uint), info.max_allocation);
    EXPECT_GT(parts.tiles_per_batch, 50u);
}

// Draws have no room for more nodes.
TEST(frame, too_many_lights_for_cuts_are_refused) {
    Scene scene = test::scene_named("points").scene;
    const WideBvh bvh = build_wide_bvh(scene, 8, 8, 10);
    scene.lights.resize((std::size_t{1} << 22) + 1);
    EXPECT_THROW(
        (void)make_plan(test::devices().front().info(), scene, bvh, small_options("adaptive")),
        InputError);
}

// A render that is interrupted at any moment has whole pixel samples, of some pixels maybe none.
TEST(frame, interrupts_leave_whole_samples) {
    const test::TestScene& scene = test::scene_named("many");
    // Between two passes of adaptive, and in the second batch of contribution.
    for (const char* sampler : {"adaptive", "contribution"}) {
        SCOPED_TRACE(sampler);
        RenderOptions options = small_options(sampler);
        options.clusters.tile_size = 8;
        options.pixel_centre = true;
        options.memory = 20'000'000;
        options.spp = 1;
        const Device& device = test::devices().front();
        const FrameResult whole = test::render(device, scene, options);
        EXPECT_FALSE(whole.is_cut_short);
        EXPECT_EQ(whole.empty_pixels, 0u);
        unsigned asked = 0;
        options.interrupted = [&asked] { return ++asked > 4; };
        const FrameResult part = test::render(device, scene, options);
        EXPECT_TRUE(part.is_cut_short);
        EXPECT_GT(part.empty_pixels, 0u);
        EXPECT_LT(part.empty_pixels, whole.image.pixel_count());
        EXPECT_NEAR(part.spp,
                    1 - static_cast<double>(part.empty_pixels) / whole.image.pixel_count(), 1e-6);
        std::size_t black = 0;
        for (std::size_t i = 0; i < whole.image.values.size(); ++i) {
            black += part.image.values[i] == 0 && whole.image.values[i] != 0;
            if (part.image.values[i] != 0) {
                EXPECT_EQ(part.image.values[i], whole.image.values[i]);
            }
        }
        EXPECT_GT(black, 0u);
        options.interrupted = [] { return true; };
        EXPECT_EQ(test::render(device, scene, options).spp, 0);
    }
}

// Less memory means more batches, not another image.
TEST(frame, batches_do_not_change_the_image) {
    FOR_EACH_DEVICE(device)
    for (const Sampler& sampler : all_samplers()) {
        const test::TestScene& scene = test::scene_named("many");
        RenderOptions options = small_options(sampler.name);
        options.clusters.tile_size = 8;
        options.width = scene.width;
        options.height = scene.height;
        const WideBvh bvh = build_wide_bvh(scene.scene, 8, 8, 10);
        const auto batches = [&](std::size_t memory) {
            options.memory = memory;
            return Frame(device, scene.scene, bvh, scene.camera, options).plan().batches;
        };
        EXPECT_EQ(batches(1 << 30), 1u);
        const std::size_t little = 20'000'000;
        EXPECT_GT(batches(little), sampler.clusters ? 3u : 0u);
        if (sampler.large_batches) continue;  // what it makes of a batch holds there
        options.memory = 1 << 30;
        const FrameResult whole = test::render(device, scene, options);
        options.memory = little;
        const FrameResult parts = test::render(device, scene, options);
        EXPECT_EQ(whole.image.values, parts.image.values) << sampler.name;
        EXPECT_EQ(whole.clusters, parts.clusters);
        EXPECT_EQ(whole.shadow_rays, parts.shadow_rays);
    }
}

// Light samples weigh pixel samples, but not of samplers to whose rays they hardly matter.
TEST(frame, pixel_samples_weigh_what_they_take) {
    RenderOptions options;
    for (const Sampler& sampler : all_samplers()) {
        options.sampler = sampler.name;
        const Schedule schedule(options, Plan{}, 100);
        EXPECT_EQ(schedule.weight(3), 1) << sampler.name;
        EXPECT_EQ(schedule.weight(4), sampler.own_rays || sampler.all_lights ? 1 : 4)
            << sampler.name;
    }
}

TEST(frame, too_little_memory_is_refused) {
    const test::TestScene& scene = test::scene_named("many");
    RenderOptions options = small_options("contribution");
    options.memory = 100'000;
    FOR_EACH_DEVICE(device) EXPECT_THROW((void)test::render(device, scene, options), InputError);
}

// What a plan promises is what the device holds at most (besides the scene-wide odds and ends).
TEST(frame, plan_covers_the_peak) {
    const test::TestScene& scene = test::scene_named("many");
    for (std::size_t i = 0; i < list_devices().size(); ++i) {
        if (!list_devices()[i].usable) continue;
        Device device = Device::open(std::to_string(i));  // its peak starts at 0
        RenderOptions options = small_options("contribution-defensive");
        options.width = scene.width;
        options.height = scene.height;
        const WideBvh bvh = build_wide_bvh(scene.scene, 8, 8, 10);
        Frame frame(device, scene.scene, bvh, scene.camera, options);
        frame.prepare();
        Progress quiet("", true);
        (void)frame.render(quiet);
        const Plan& plan = frame.plan();
        const std::size_t planned = plan.scene_bytes + plan.image_bytes + plan.batch_bytes;
        EXPECT_LE(device.peak_bytes(), planned);
        EXPECT_GE(device.peak_bytes(), planned * 9 / 10);
    }
}

// An image without whole tiles has every pixel traced, clustered and lit: the camera is in a room.
TEST(frame, odd_sizes) {
    FOR_EACH_DEVICE(device)
    for (const auto& [width, height] : {std::pair(1u, 1u), {33u, 1u}, {31u, 65u}}) {
        test::TestScene scene = test::scene_named("many");
        scene.width = width;
        scene.height = height;
        RenderOptions options = small_options("contribution-defensive");
        options.aovs = {"depth", "visible_share"};
        const FrameResult result = test::render(device, scene, options);
        ASSERT_EQ(result.image.pixel_count(), width * height);
        for (const float value : result.image.values) EXPECT_GT(value, 0);
        for (const auto& [name, image] : result.aovs)
            for (const float value : image.values) EXPECT_GT(value, 0) << name;
    }
}

TEST(frame, scene_without_lights_is_black) {
    const test::TestScene scene = test::make_scene([](GltfWriter& out) {
        Mesh plane;
        plane.add_quad({-5, -1, 5}, {10, 0, 0}, {0, 0, -10});
        out.add_mesh("plane", plane, out.add_diffuse(glm::vec3(0.5f)));
    });
    FOR_EACH_DEVICE(device)
    for (const Sampler& sampler : all_samplers())
        for (const float value :
             test::render(device, scene, small_options(sampler.name)).image.values)
            ASSERT_EQ(value, 0);
}

// A light seen directly shows its radiance, on the side that emits.
TEST(frame, emitters_are_seen) {
    const test::TestScene scene = test::make_scene(
        [](GltfWriter& out) {
            Mesh lamp;
            lamp.add_quad({-1, -1, -3}, {2, 0, 0}, {0, 2, 0});
            out.add_mesh("lamp", lamp, out.add_emitter({4, 2, 1}));
            out.add_camera("front", {0, 0, 0}, {0, 0, -1}, 0.1f, 1);
            out.add_camera("back", {0, 0, -6}, {0, 0, -3}, 0.1f, 1);
        },
        4, 4);
    FOR_EACH_DEVICE(device) {
        const FrameResult front = test::render(device, scene, small_options("uniform"));
        EXPECT_FLOAT_EQ(front.image.values[0], 4);
        EXPECT_FLOAT_EQ(front.image.values[2], 1);
        RenderOptions hidden = small_options("uniform");
        hidden.hide_emitters = true;
        EXPECT_EQ(test::render(device, scene, hidden).image.values[0], 0);
        test::TestScene behind = scene;
        behind.camera = make_camera(find_view(scene.scene, "back"), 4, 4);
        EXPECT_EQ(test::render(device, behind, small_options("uniform")).image.values[0], 0);
    }
}

namespace {

const Image& layer(const FrameResult& result, std::string_view name) {
    for (const auto& [key, image] : result.aovs)
        if (key == name) return image;
    throw std::logic_error("no layer");
}

}  // namespace

// The G-buffer's layers against the reference's surfaces at the pixels' centres.
TEST(frame, surface_layers) {
    const test::TestScene& scene = test::scene_named("kinds");
    const reference::Tracer tracer(scene.scene);
    const Tiles tiles = all_tiles(scene.width, scene.height, 32);
    RenderOptions options = small_options("uniform");
    options.aovs = {"normal", "depth", "position", "albedo"};
    FOR_EACH_DEVICE(device) {
        const FrameResult result = test::render(device, scene, options);
        ASSERT_EQ(result.aovs.size(), 4u);
        int edges = 0;
        int hits = 0;
        reference::for_each_pixel(tiles, [&](uint x, uint y, std::size_t) {
            const Surface s =
                reference::gbuffer(scene.scene, tracer, scene.camera, tiles, x, y, false, 0, 0);
            const bool hit = s.position.w >= 0;
            const float depth = *layer(result, "depth").at(x, y);
            if (std::abs(depth - (hit ? s.position.w : 0)) > 1e-3f) {
                ++edges;  // another triangle is hit
                return;
            }
            hits += hit;
            const float4 albedo = hit ? scene.scene.materials[s.material].base_color : float4(0);
            for (int c = 0; c < 3; ++c) {
                EXPECT_NEAR(layer(result, "normal").at(x, y)[c], hit ? s.normal[c] : 0, 1e-3);
                EXPECT_NEAR(layer(result, "position").at(x, y)[c], hit ? s.position[c] : 0, 1e-3);
                EXPECT_EQ(layer(result, "albedo").at(x, y)[c], albedo[c]);
            }
        });
        EXPECT_LE(edges, 5);
        EXPECT_GT(hits, 1000);
    }
}

// The clusters' layers, made in batches, against one clustering of the whole image.
TEST(frame, cluster_layers) {
    const test::TestScene& scene = test::scene_named("many");
    RenderOptions options = small_options("contribution");
    options.clusters.tile_size = 16;
    options.memory = 21'000'000;
    options.aovs = {"cluster", "representative", "visible_share", "lights"};
    const Tiles tiles = all_tiles(scene.width, scene.height, 16);
    FOR_EACH_DEVICE(shared) {
        const FrameResult result = test::render(shared, scene, options);
        Device device = shared;
        const unsigned lanes = device.form().bvh_width;
        const WideBvh bvh =
            build_wide_bvh(scene.scene, lanes, lanes, reach_of(scene.scene, scene.camera));
        const DeviceScene uploaded = upload_scene(device, scene.scene, bvh, scene.camera);
        Buffer<Surface> surfaces = device.allocate<Surface>(item_count(tiles));
        GBufferStage(device, uploaded).trace(tiles, {}, surfaces);
        Clustering whole(device, uploaded, options.clusters, tiles.count);
        whole.build(tiles, surfaces, [](std::size_t) {});
        const std::vector<uint> rows = whole.item_rows();
        const std::vector<uint> representatives = whole.representatives();
        const std::vector<RowSum> totals = whole.totals();
        std::map<uint, float> numbers;  // by row
        std::set<float> distinct;
        reference::for_each_pixel(tiles, [&](uint x, uint y, std::size_t item) {
            const uint row = rows[item];
            const float number = *layer(result, "cluster").at(x, y);
            EXPECT_EQ(numbers.emplace(row, number).first->second, number);
            distinct.insert(number);
            EXPECT_EQ(*layer(result, "representative").at(x, y), representatives[row] == item);
            EXPECT_EQ(*layer(result, "lights").at(x, y), totals[row].visible_count);
            EXPECT_FLOAT_EQ(*layer(result, "visible_share").at(x, y),
                            static_cast<float>(totals[row].visible_count) /
                                static_cast<float>(std::max(totals[row].facing_count, 1u)));
        });
        EXPECT_EQ(distinct.size(), numbers.size());
        EXPECT_EQ(distinct.size(), result.clusters);
        EXPECT_EQ(*distinct.begin(), 0);
        EXPECT_EQ(static_cast<std::size_t>(*distinct.rbegin()) + 1, result.clusters);
        EXPECT_GT(result.clusters, tiles.count);
        options.width = scene.width;
        options.height = scene.height;
        EXPECT_GT(Frame(device, scene.scene, bvh, scene.camera, options).plan().batches, 1u);
    }
}

// One bright light and 200,000 dim ones: none is lost to rounding (paper (1) in single precision).
TEST(frame, dim_lights_are_not_lost_beside_a_bright_one) {
    Mesh plane;
    plane.add_quad({-5, 0, 5}, {10, 0, 0}, {0, 0, -10});
    test::TestScene scene = test::make_scene(
        [&](GltfWriter& out) {
            out.add_mesh("plane", plane, out.add_diffuse(glm::vec3(0.5f)));
            out.add_point({0, 1, 0}, glm::vec3(1000));
            out.add_point({0, 1, 0}, glm::vec3(2e-5f));
            out.add_camera("down", {0, 3, 1e-4f}, {0, 0, 0}, 0.001f, 1);
        },
        1, 1);
    scene.scene.lights.resize(200'001, scene.scene.lights[1]);
    const double expected = 0.5 / 3.14159265358979 * (1000 + 200'000 * 2e-5);
    for (const Device& device : test::devices()) {
        const FrameResult result = test::render(device, scene, small_options("exhaustive"));
        EXPECT_NEAR(result.image.values[0], expected, 2e-6 * expected) << test::label(device);
    }
}

// A kernel holds no code for kinds of lights, materials or meshes that the scene does not have.
TEST(frame, kernels_are_compiled_for_the_scene_at_hand) {
    const auto defines = [](const std::string& name) {
        const test::TestScene& s = test::scene_named(name);
        Device device = test::devices().front();
        const WideBvh bvh = build_wide_bvh(s.scene, 8, 8, 10);
        const DeviceScene uploaded = upload_scene(device, s.scene, bvh, s.camera);
        Defines all = uploaded.shading;
        all.insert(uploaded.surfaces.begin(), uploaded.surfaces.end());
        all.insert(uploaded.emission.begin(), uploaded.emission.end());
        std::string set;
        for (const auto& [key, value] : all)
            if (key.starts_with("HAS_") && value) set += key.substr(4) + " ";
        return set;
    };
    EXPECT_EQ(defines("points"), "EVEN POINT RANGE ");
    EXPECT_EQ(defines("oriented"), "COSINE EMISSION ORIENTED ");
    EXPECT_EQ(
        defines("kinds"),
        "AREA CONE COSINE DIRECTIONAL EMISSION EVEN GGX INFINITE POINT QUAD RANGE SMOOTH SPOT "
        "TRIANGLE ");
}

}  // namespace manylight

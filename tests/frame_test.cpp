// SPDX-License-Identifier: MIT
#include "error.hpp"
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
        const std::size_t little = 900'000;
        EXPECT_GT(batches(little), sampler.table == Table::clusters ? 3u : 0u);
        options.memory = 1 << 30;
        const FrameResult whole = test::render(device, scene, options);
        options.memory = little;
        const FrameResult parts = test::render(device, scene, options);
        EXPECT_EQ(whole.image.values, parts.image.values) << sampler.name;
        EXPECT_EQ(whole.clusters, parts.clusters);
        EXPECT_EQ(whole.shadow_rays, parts.shadow_rays);
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
    for (const Device& shared : test::devices()) {
        Device device = Device::open(shared.info().name);  // its peak starts at 0
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
        test::TestScene behind = scene;
        behind.camera = make_camera(find_view(scene.scene, "back"), 4, 4);
        EXPECT_EQ(test::render(device, behind, small_options("uniform")).image.values[0], 0);
    }
}

// Each AOV against what the G-buffer and the clusters of the whole image say.
TEST(frame, aovs) {
    const test::TestScene& scene = test::scene_named("oriented");
    RenderOptions options = small_options("contribution");
    for (const Aov& aov : all_aovs()) options.aovs.emplace_back(aov.name);
    FOR_EACH_DEVICE(device) {
        FrameResult result = test::render(device, scene, options);
        ASSERT_EQ(result.aovs.size(), all_aovs().size());
        const auto layer = [&](std::string_view name) -> Image& {
            for (auto& [key, image] : result.aovs)
                if (key == name) return image;
            throw std::logic_error("no layer");
        };
        std::size_t representatives = 0;
        float most = 0;
        for (unsigned y = 0; y < scene.height; ++y)
            for (unsigned x = 0; x < scene.width; ++x) {
                const float* n = layer("normal").at(x, y);
                const float length = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
                const bool hit = *layer("depth").at(x, y) > 0;
                EXPECT_NEAR(length, hit ? 1 : 0, 1e-5);
                EXPECT_NEAR(layer("albedo").at(x, y)[0], hit ? 0.6 : 0, 0.61);
                const float share = *layer("visible_share").at(x, y);
                EXPECT_TRUE(share >= 0 && share <= 1);
                EXPECT_LE(*layer("lights").at(x, y), 16);
                representatives += *layer("representative").at(x, y) == 1;
                most = std::max(most, *layer("cluster").at(x, y));
            }
        EXPECT_EQ(static_cast<std::size_t>(most) + 1, result.clusters);
        EXPECT_LE(representatives, result.clusters);
        EXPECT_GT(representatives, result.clusters / 2);  // the others saw only background
    }
}

// A kernel holds no code for kinds of lights, materials or meshes that the scene does not have.
TEST(frame, kernels_are_compiled_for_the_scene_at_hand) {
    const auto defines = [](const std::string& name) {
        const test::TestScene& s = test::scene_named(name);
        Device device = test::devices().front();
        const DeviceScene uploaded =
            upload_scene(device, s.scene, build_wide_bvh(s.scene, 8, 8, 10), s.camera);
        Defines all = uploaded.shading;
        all.insert(uploaded.surfaces.begin(), uploaded.surfaces.end());
        all.insert(uploaded.emission.begin(), uploaded.emission.end());
        std::string set;
        for (const auto& [key, value] : all)
            if (key.starts_with("HAS_") && value) set += key.substr(4) + " ";
        return set;
    };
    EXPECT_EQ(defines("points"), "POINT ");
    EXPECT_EQ(defines("oriented"), "EMISSION ORIENTED ");
    EXPECT_EQ(defines("kinds"), "DIRECTIONAL EMISSION GGX POINT SMOOTH SPOT TRIANGLE ");
}

}  // namespace manylight

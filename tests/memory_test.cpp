// SPDX-License-Identifier: MIT
// What is allocated on a device, against what was planned: no more, and not much less.
#include <stdexcept>

#include "support.hpp"

namespace manylight {
namespace {

// Plans may promise a tenth too much, and a few KiB for small scenes.
void expect_planned(const PartMemory& part) {
    SCOPED_TRACE(part.part);
    EXPECT_LE(part.use->most, part.planned);
    EXPECT_GE(static_cast<double>(part.use->most), 0.9 * static_cast<double>(part.planned) - 4096);
}

RenderOptions options_of(std::string_view sampler, const test::TestScene& scene) {
    RenderOptions options;
    options.sampler = sampler;
    options.width = scene.width;
    options.height = scene.height;
    options.clusters.tile_size = 16;
    return options;
}

WideBvh bvh_for(const Device& device, const test::TestScene& scene) {
    const unsigned width = device.form().bvh_width;
    return build_wide_bvh(scene.scene, width, width, 10);
}

// Makes a sampler without preparing it: tables of the whole image may be made only then.
void expect_footprint(const Sampler& sampler, Device& device, const DeviceScene& uploaded,
                      const test::TestScene& scene, unsigned tiles, uint light_samples) {
    ClusterOptions clusters;
    clusters.tile_size = sampler.tile_size > 0 ? sampler.tile_size : 16;
    const ParameterValues parameters = values_of(sampler);
    const Footprint need =
        sampler.footprint({static_cast<uint>(scene.scene.lights.size()), tiles, clusters.tile_size,
                           light_samples, clusters, parameters});
    const std::size_t planned = need.fixed + need.image + tiles * need.tile;
    const auto use = std::make_shared<MemoryUse>();
    const Counting counting(device, use);
    const std::unique_ptr<LightSampler> made =
        sampler.make({device, uploaded, scene.scene.lights, tiles, clusters.tile_size, 64,
                      light_samples, clusters, parameters});
    (void)made->find_seen_lights(1);
    EXPECT_LE(use->most, planned);
    EXPECT_GE(static_cast<double>(use->most + need.image),
              0.9 * static_cast<double>(planned) - 4096);
    EXPECT_LE(need.tile_buffer, need.tile);
    EXPECT_LE(need.tile_matrix, need.tile);
}

// Renders and judges every part of the frame.
void expect_frame_planned(const Device& device, const test::TestScene& scene,
                          const RenderOptions& options, unsigned batches) {
    const WideBvh bvh = bvh_for(device, scene);
    Frame frame(device, scene.scene, bvh, scene.camera, options);
    EXPECT_EQ(frame.plan().batches, batches);
    frame.prepare();
    Progress quiet("", true);
    (void)frame.render(quiet);
    std::size_t planned = 0;
    for (const PartMemory* part : frame.memory().parts()) {
        expect_planned(*part);
        planned += part->planned;
    }
    EXPECT_EQ(frame.plan().total_bytes(), planned);
}

}  // namespace

TEST(memory, counts_what_lives) {
    FOR_EACH_DEVICE(each) {
        Device device = each;
        const auto outer = std::make_shared<MemoryUse>();
        const auto inner = std::make_shared<MemoryUse>();
        const auto allocate = [&](std::size_t bytes) { return device.allocate<char>(bytes); };
        {
            const Counting counting(device, outer);
            const Buffer<char> first = allocate(100);
            {
                const Counting other(device, inner);
                (void)allocate(1000);
            }
            (void)allocate(20);
            const Buffer<char> same = first;  // copies share it
        }
        (void)allocate(5000);
        EXPECT_EQ(outer->most, 120u);
        EXPECT_EQ(outer->live, 0u);
        EXPECT_EQ(inner->most, 1000u);
        EXPECT_EQ(inner->live, 0u);
    }
}

TEST(memory, more_than_planned_is_an_error) {
    Device device = test::devices()[0];
    PartMemory part{"sampler nearest", 100};
    const auto allocate = [&](std::size_t bytes) {
        const Counting counting(device, part.use);
        (void)device.allocate<char>(bytes);
    };
    allocate(100);
    allocate(100);  // the other is gone
    part.check();
    allocate(101);
    try {
        part.check();
        FAIL();
    } catch (const std::logic_error& error) {
        EXPECT_STREQ(error.what(),
                     "sampler nearest: 101 bytes were allocated on the device, and 100 planned");
    }
}

// Every row, in forms of all kinds, for batches of any size: no kernel is built.
TEST(memory, footprints_are_true) {
    for (const unsigned lanes : {16u, 1u}) {
        Device device = Device::open("", 0, lanes);
        for (const char* name : {"points", "kinds", "many"}) {
            const test::TestScene& scene = test::scene_named(name);
            const LightTree tree = build_light_tree(scene.scene.lights);
            const WideBvh bvh = bvh_for(device, scene);
            const DeviceScene uploaded =
                upload_scene(device, scene.scene, bvh, scene.camera, &tree);
            for (const Sampler& sampler : all_samplers())
                for (const unsigned tiles : {1u, 12u})
                    for (const uint light_samples : {1u, 16u, 100u}) {
                        SCOPED_TRACE(fmt::format("{}, {} lanes, {}, {} tiles, {} light samples",
                                                 sampler.name, lanes, name, tiles, light_samples));
                        expect_footprint(sampler, device, uploaded, scene, tiles, light_samples);
                    }
        }
    }
}

// Whole frames: what is allocated as they render counts as well.
TEST(memory, frames_are_planned) {
    const test::TestScene& scene = test::scene_named("kinds");
    FOR_EACH_DEVICE(device)
    for (const Sampler& sampler : all_samplers()) {
        SCOPED_TRACE(sampler.name);
        RenderOptions options = options_of(sampler.name, scene);
        options.spp = 2;
        options.aovs = {"normal", "error"};
        expect_frame_planned(device, scene, options, 1);
        const WideBvh bvh = bvh_for(device, scene);
        options.aovs.clear();
        options.spp = 1;
        options.memory = make_plan(device.info(), scene.scene, bvh, options).total_bytes() - 1;
        expect_frame_planned(device, scene, options, 2);
    }
}

// Stage reflections keeps what its rays have met, and where cells lie.
TEST(memory, reflections_are_planned) {
    test::TestScene scene = test::scene_named("kinds");
    for (Material& material : scene.scene.materials) material.roughness = 0.01f;
    ASSERT_TRUE(find_features(scene.scene).reflections);
    FOR_EACH_DEVICE(device)
    for (const char* sampler : {"lighttree", "adaptive"}) {
        SCOPED_TRACE(sampler);
        const RenderOptions options = options_of(sampler, scene);
        expect_frame_planned(device, scene, options, 1);
    }
}

// Nothing is planned or made of a sampler that has nothing to draw.
TEST(memory, no_lights_take_none) {
    test::TestScene scene = test::scene_named("kinds");
    scene.scene.lights.clear();
    FOR_EACH_DEVICE(device)
    for (const Sampler& sampler : all_samplers()) {
        SCOPED_TRACE(sampler.name);
        const RenderOptions options = options_of(sampler.name, scene);
        expect_frame_planned(device, scene, options, 1);
        const WideBvh bvh = bvh_for(device, scene);
        EXPECT_EQ(make_plan(device.info(), scene.scene, bvh, options).sampler_bytes, 0u);
    }
}

}  // namespace manylight

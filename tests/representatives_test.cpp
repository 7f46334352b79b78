// SPDX-License-Identifier: MIT
#include "reference/tiles.hpp"
#include "support.hpp"

namespace manylight {
namespace {

uint pick(Device device, const Tiles& tiles, const std::vector<Surface>& surfaces,
          const Region& region) {
    const Buffer<Region> regions = device.upload(std::vector<Region>{region});
    Buffer<uint> found = device.allocate<uint>(1);
    RepresentativeStage(device).pick(tiles, device.upload(surfaces), regions, 0, 1, found);
    return found.download()[0];
}

}  // namespace

TEST(representatives, agree_with_the_reference) {
    FOR_EACH_DEVICE(device)
    for (const std::string& scene : test::scene_names()) {
        SCOPED_TRACE(scene);
        test::expect_stage("representatives", test::verifier(scene, device));
    }
}

TEST(representatives, centre_or_the_nearest_hit) {
    const Tiles tiles = all_tiles(30, 20, 32);
    std::vector<Surface> surfaces(1024);
    for (Surface& s : surfaces) s.position.w = 1;
    const auto item = [&](uint x, uint y) { return reference::item_of(tiles, x, y); };
    FOR_EACH_DEVICE(device) {
        EXPECT_EQ(pick(device, tiles, surfaces, {8, 4, 8, 2, 0, 0}), item(12, 8));
        EXPECT_EQ(pick(device, tiles, surfaces, {5, 6, 1, 5, 0, 0}), item(5, 6));
        // Beyond the image's edge the centre moves in.
        EXPECT_EQ(pick(device, tiles, surfaces, {0, 16, 16, 1, 0, 0}), item(8, 19));
        // Centre missed: the nearest pixel, and of two at the same distance the first row's.
        std::vector<Surface> holes = surfaces;
        holes[item(12, 8)].position.w = -1;
        EXPECT_EQ(pick(device, tiles, holes, {8, 4, 8, 2, 0, 0}), item(12, 7));
        holes[item(12, 7)].position.w = -1;
        EXPECT_EQ(pick(device, tiles, holes, {8, 4, 8, 2, 0, 0}), item(11, 8));
        for (Surface& s : holes) s.position.w = -1;
        EXPECT_EQ(pick(device, tiles, holes, {8, 4, 8, 2, 0, 0}), NO_ITEM);
    }
}

}  // namespace manylight

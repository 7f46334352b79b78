// SPDX-License-Identifier: MIT
#include "reference/clusters.hpp"

#include "support.hpp"

namespace manylight {
namespace {

Surface facing(glm::vec3 normal) {
    Surface s{};
    s.position = float4(0, 0, 0, 1);
    s.normal = float4(normal, 0);
    return s;
}

Surface missed() {
    Surface s{};
    s.position.w = -1;
    return s;
}

// The leaves of one tile, as the device splits it by normals.
std::vector<Region> leaves(Device device, const Tiles& tiles, const std::vector<Surface>& surfaces,
                           uint max_level) {
    ClusterStage stage(device);
    const Buffer<Surface> uploaded = device.upload(surfaces);
    std::vector<Region> level = root_regions(tiles);
    std::vector<Region> out;
    while (!level.empty()) {
        const Buffer<Region> regions = device.upload(level);
        Buffer<uint> split = device.allocate<uint>(level.size());
        stage.split(tiles, uploaded, regions, static_cast<uint>(level.size()), 0.98f, max_level,
                    split);
        const std::vector<uint> marks = split.download();
        std::vector<Region> next;
        for (std::size_t i = 0; i < level.size(); ++i) {
            if (!marks[i])
                out.push_back(level[i]);
            else
                for (const Region& q : quarters(level[i], tiles)) next.push_back(q);
        }
        level = next;
    }
    return out;
}

}  // namespace

TEST(clusters, agree_with_the_reference) {
    FOR_EACH_DEVICE(device)
    for (const std::string& scene : test::scene_names()) {
        SCOPED_TRACE(scene);
        test::expect_stage("clusters", test::verifier(scene, device));
    }
}

TEST(clusters, flat_tile_is_one_cluster) {
    const Tiles tiles = all_tiles(32, 32, 32);
    const std::vector<Surface> surfaces(1024, facing({0, 1, 0}));
    FOR_EACH_DEVICE(device) EXPECT_EQ(leaves(device, tiles, surfaces, 5).size(), 1u);
}

TEST(clusters, background_alone_is_one_cluster) {
    const Tiles tiles = all_tiles(32, 32, 32);
    const std::vector<Surface> surfaces(1024, missed());
    FOR_EACH_DEVICE(device) EXPECT_EQ(leaves(device, tiles, surfaces, 5).size(), 1u);
}

// One odd corner pixel: its quarter is split at every level, three siblings stay.
TEST(clusters, odd_corner_is_split_to_the_maximum_depth) {
    const Tiles tiles = all_tiles(32, 32, 32);
    for (const Surface& odd : {facing({1, 0, 0}), missed()}) {
        std::vector<Surface> surfaces(1024, facing({0, 1, 0}));
        surfaces[0] = odd;
        FOR_EACH_DEVICE(device) {
            for (uint depth = 0; depth <= 5; ++depth) {
                const std::vector<Region> found = leaves(device, tiles, surfaces, depth);
                EXPECT_EQ(found.size(), 1 + 3 * depth);
                EXPECT_EQ(found.back().size, 32u >> depth);
            }
            EXPECT_EQ(leaves(device, tiles, surfaces, 7).size(), 16u);  // pixels are not split
        }
    }
}

// An image of 40 x 35 pixels: the corners that count are those in the image, and quarters that lie
// outside are left out.
TEST(clusters, image_edge_cuts_regions) {
    const Tiles tiles = all_tiles(40, 35, 32);
    ASSERT_EQ(tiles.count, 4u);
    std::vector<Surface> surfaces(4 * 1024, facing({0, 1, 0}));
    FOR_EACH_DEVICE(device) {
        EXPECT_EQ(leaves(device, tiles, surfaces, 5).size(), 4u);
        std::vector<Surface> odd = surfaces;
        odd[3 * 1024 + 0b011111] = facing({0, 0, 1});  // pixel (7, 3) of the last tile: outside
        EXPECT_EQ(leaves(device, tiles, odd, 5).size(), 4u);
        odd[3 * 1024 + 0b011101] = facing({0, 0, 1});  // pixel (7, 2): its lower right corner
        const std::vector<Region> found = leaves(device, tiles, odd, 5);
        std::size_t pixels = 0;
        for (const Region& r : found)
            pixels += (std::min(r.x + r.size, 40u) - r.x) * (std::min(r.y + r.size, 35u) - r.y);
        EXPECT_EQ(pixels, 40u * 35u);
        EXPECT_EQ(found.size(), 3u + 6u);
    }
}

}  // namespace manylight

// SPDX-License-Identifier: MIT
#include "support.hpp"

namespace manylight {
namespace {

RowSum sees(uint visible, uint facing) { return {0, 0, visible, facing}; }

std::vector<uint> split(Device device, const std::vector<Region>& regions,
                        const std::vector<RowSum>& totals, bool weighed = false) {
    Buffer<uint> marks = device.allocate<uint>(regions.size());
    RefinementStage(device).split(device.upload(regions), device.upload(totals), 0,
                                  static_cast<uint>(regions.size()), {weighed, 0.5f}, 3, marks);
    return marks.download();
}

}  // namespace

TEST(refinement, agrees_with_the_reference) {
    FOR_EACH_DEVICE(device)
    for (const std::string& scene : test::scene_names()) {
        SCOPED_TRACE(scene);
        test::expect_stage("refinement", test::verifier(scene, device));
    }
}

// The paper's rules, with threshold 0.5 and maximum depth 3.
TEST(refinement, umbra_and_penumbra) {
    const Region leaf{0, 0, 16, 1, 0, 0};
    const Region deepest{0, 0, 4, 3, 0, 0};
    const Region pixel{0, 0, 1, 2, 0, 0};
    const std::vector<Region> four(4, Region{0, 0, 8, 2, 0, 4});
    using Marks = std::vector<uint>;
    FOR_EACH_DEVICE(device) {
        EXPECT_EQ(split(device, {leaf}, {sees(10, 10)}), Marks{0}) << "lit";
        EXPECT_EQ(split(device, {leaf}, {sees(5, 10)}), Marks{0}) << "at the threshold";
        EXPECT_EQ(split(device, {leaf}, {sees(4, 10)}), Marks{1}) << "in shadow";
        EXPECT_EQ(split(device, {leaf}, {sees(0, 0)}), Marks{0}) << "no light faces it";
        EXPECT_EQ(split(device, {deepest}, {sees(0, 10)}), Marks{0}) << "at the maximum depth";
        EXPECT_EQ(split(device, {pixel}, {sees(0, 10)}), Marks{0}) << "a pixel";
        const RowSum dark = sees(1, 10);
        const RowSum lit = sees(9, 10);
        EXPECT_EQ(split(device, four, {dark, dark, dark, dark}), (Marks{0, 0, 0, 0})) << "umbra";
        EXPECT_EQ(split(device, four, {dark, lit, dark, lit}), (Marks{1, 0, 1, 0})) << "penumbra";
        EXPECT_EQ(split(device, four, {dark, dark, dark, sees(0, 0)}), (Marks{0, 0, 0, 0}))
            << "umbra beside a pixel that no light faces";
    }
}

// A representative that sees one light of ten, which gives most of what could reach it, is lit
// where lights are weighed by their contribution.
TEST(refinement, weighed_by_contribution) {
    const Region leaf{0, 0, 16, 1, 0, 0};
    FOR_EACH_DEVICE(device) {
        const RowSum bright{8, 10, 1, 10};
        EXPECT_EQ(split(device, {leaf}, {bright}, false), std::vector<uint>{1});
        EXPECT_EQ(split(device, {leaf}, {bright}, true), std::vector<uint>{0});
        const RowSum dim{2, 10, 9, 10};
        EXPECT_EQ(split(device, {leaf}, {dim}, false), std::vector<uint>{0});
        EXPECT_EQ(split(device, {leaf}, {dim}, true), std::vector<uint>{1});
    }
}

}  // namespace manylight

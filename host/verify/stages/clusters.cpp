// SPDX-License-Identifier: MIT
// Stage clusters.
#include <cmath>

#include "reference/clusters.hpp"
#include "reference/tiles.hpp"
#include "verify/stages.hpp"
#include "verify/tolerances.hpp"

namespace manylight {
namespace {

Check clusters(Verifier& verifier) {
    Check check{.stage = "clusters", .tolerance = exact};
    ClusterStage stage(verifier.device());
    const float cos_threshold =
        std::cos(glm::radians(verifier.options().clusters.normal_threshold));
    std::vector<Region> level = root_regions(verifier.tiles());
    Buffer<Region> regions = verifier.device().allocate<Region>(
        std::size_t{verifier.tiles().count} * most_regions(verifier.options().clusters));
    Buffer<uint> split = verifier.device().allocate<uint>(regions.size());
    while (!level.empty()) {
        const auto count = static_cast<uint>(level.size());
        regions.upload(level);
        stage.split(verifier.tiles(), verifier.surfaces(), regions, count, cos_threshold,
                    verifier.options().clusters.max_depth, split);
        const std::vector<uint> found = split.download(0, count);
        const std::vector<uint> expected =
            reference::split_by_normals(verifier.tiles(), verifier.found_surfaces(), level,
                                        cos_threshold, verifier.options().clusters.max_depth);
        std::vector<Region> next;
        for (uint i = 0; i < count; ++i) {
            check.compare_exact(
                found[i] == expected[i],
                fmt::format("region ({}, {}) of {} pixels", level[i].x, level[i].y, level[i].size));
            if (!expected[i]) continue;
            for (const Region& quarter : quarters(level[i], verifier.tiles()))
                next.push_back(quarter);
        }
        level = std::move(next);
    }
    if (verifier.scene().lights.empty()) return check;
    const std::vector<uint> rows = verifier.clustering().item_rows();
    const std::vector<uint> expected = reference::assign_rows(
        verifier.tiles(), verifier.clustering().regions(), verifier.clustering().split());
    reference::for_each_pixel(verifier.tiles(), [&](uint x, uint y, std::size_t item) {
        check.compare_exact(rows[item] == expected[item],
                            fmt::format("pixel ({}, {}): its cluster", x, y));
    });
    return check;
}

}  // namespace

StageCheck check_clusters() { return {.stages = {"clusters"}, .run = single<clusters>}; }

}  // namespace manylight

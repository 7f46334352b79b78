// SPDX-License-Identifier: MIT
// Stages that work on clusters: clusters, representatives, contributions, refinement.
#include <cmath>

#include "reference/clusters.hpp"
#include "reference/contributions.hpp"
#include "reference/refinement.hpp"
#include "reference/representatives.hpp"
#include "reference/tiles.hpp"
#include "verify/tolerances.hpp"
#include "verify/verify.hpp"

namespace manylight {

Check Verifier::clusters() {
    Check check{.stage = "clusters", .tolerance = exact};
    ClusterStage stage(device_);
    const float cos_threshold = std::cos(glm::radians(options_.clusters.normal_threshold));
    std::vector<Region> level = root_regions(tiles_);
    Buffer<Region> regions =
        device_.allocate<Region>(std::size_t{tiles_.count} * most_regions(options_.clusters));
    Buffer<uint> split = device_.allocate<uint>(regions.size());
    while (!level.empty()) {
        const auto count = static_cast<uint>(level.size());
        regions.upload(level);
        stage.split(tiles_, surfaces_, regions, count, cos_threshold, options_.clusters.max_depth,
                    split);
        const std::vector<uint> found = split.download(0, count);
        const std::vector<uint> expected = reference::split_by_normals(
            tiles_, found_, level, cos_threshold, options_.clusters.max_depth);
        std::vector<Region> next;
        for (uint i = 0; i < count; ++i) {
            check.compare_exact(
                found[i] == expected[i],
                fmt::format("region ({}, {}) of {} pixels", level[i].x, level[i].y, level[i].size));
            if (!expected[i]) continue;
            for (const Region& quarter : quarters(level[i], tiles_)) next.push_back(quarter);
        }
        level = std::move(next);
    }
    if (scene_.lights.empty()) return check;
    const std::vector<uint> rows = clustering_.item_rows();
    const std::vector<uint> expected =
        reference::assign_rows(tiles_, clustering_.regions(), clustering_.split());
    reference::for_each_pixel(tiles_, [&](uint x, uint y, std::size_t item) {
        check.compare_exact(rows[item] == expected[item],
                            fmt::format("pixel ({}, {}): its cluster", x, y));
    });
    return check;
}

Check Verifier::representatives() {
    Check check{.stage = "representatives", .tolerance = exact};
    if (scene_.lights.empty()) return check;
    const std::vector<uint> found = clustering_.representatives();
    for (std::size_t i = 0; i < found.size(); ++i) {
        const Region& region = clustering_.regions()[i];
        check.compare_exact(
            found[i] == reference::representative(tiles_, found_, region),
            fmt::format("region ({}, {}) of {} pixels", region.x, region.y, region.size));
    }
    return check;
}

Check Verifier::contributions() {
    Check check{.stage = "contributions", .tolerance = shading_tolerance};
    const std::vector<uint> representatives = clustering_.representatives();
    const std::size_t lights = scene_.lights.size();
    std::vector<reference::Contribution> agreeing;  // about which rays pass
    // An odd stride meets every light and row in turn.
    const std::size_t stride = (matrix_.size() / options_.most_entries) | 1;
    for (std::size_t i = 0; i < matrix_.size(); i += stride) {
        const std::string where = fmt::format("row {}, light {}", i / lights, i % lights);
        const uint representative = representatives[i / lights];
        if (representative == NO_ITEM) {
            check.compare_exact(matrix_[i] == 0, where);
            continue;
        }
        const Surface& surface = found_[representative];
        const Material& material = scene_.materials[surface.shading];
        const reference::Viewer viewer = view_.of(representative);
        const Light& light = scene_.lights[i % lights];
        const reference::Contribution expected =
            reference::contribution(tracer_, surface, material, viewer, light);
        const double found = std::abs(matrix_[i]);
        double tolerance = shading_roundings * epsilon * expected.value;
        if (std::abs(found - expected.value) > tolerance / 4)
            tolerance += reference::rounding_slack(surface, material, viewer, light,
                                                   reference::centroid(light));
        check.compare(std::abs(found - expected.value), tolerance,
                      fmt::format("{}: {} is not {}", where, found, expected.value),
                      found == 0 && expected.value == 0);
        if (found == 0 || expected.value == 0) continue;
        if ((matrix_[i] < 0) == expected.hidden)
            agreeing.push_back(expected);
        else if (tracer_.occlusion_is_borderline(expected.shadow, expected.rounding)) {
            ++check.borderline;
            check.excuse(1);
        } else
            check.compare(2, 1, where + ": visibility");
    }
    check.excuse_agreeing(agreeing.size(), [&](std::size_t i) {
        return tracer_.occlusion_is_borderline(agreeing[i].shadow, agreeing[i].rounding) ? 1 : 0;
    });
    const std::vector<RowSum> totals = clustering_.totals();
    for (std::size_t row = 0; row < totals.size(); ++row) {
        const reference::RowTotal expected =
            reference::row_total(std::span(matrix_).subspan(row * lights, lights));
        // Sums in two levels: a chunk, then the chunks.
        const double roundings = LIGHT_CHUNK + chunk_count(static_cast<uint>(lights));
        const double tolerance = roundings * epsilon * expected.unshadowed;
        check.compare(std::abs(totals[row].visible - expected.visible), tolerance,
                      fmt::format("row {}: sum of the visible", row));
        check.compare(std::abs(totals[row].unshadowed - expected.unshadowed), tolerance,
                      fmt::format("row {}: sum", row));
        check.compare_exact(totals[row].visible_count == expected.visible_count &&
                                totals[row].facing_count == expected.facing_count,
                            fmt::format("row {}: counts", row));
    }
    return check;
}

Check Verifier::refinement() {
    Check check{.stage = "refinement", .tolerance = exact};
    if (scene_.lights.empty()) return check;
    const auto count = static_cast<uint>(clustering_.regions().size());
    const std::vector<RowSum> totals = clustering_.totals();
    const Buffer<Region> regions = device_.upload(clustering_.regions());
    Buffer<uint> split = device_.allocate<uint>(count);
    for (const bool weighed : {false, true}) {
        const ShadowRule rule{weighed, options_.clusters.shadow.threshold};
        RefinementStage(device_).split(regions, clustering_.matrix().totals, 0, count, rule,
                                       options_.clusters.max_depth, split);
        const std::vector<uint> found = split.download();
        const std::vector<uint> expected = reference::split_by_visibility(
            clustering_.regions(), totals, weighed, rule.threshold, options_.clusters.max_depth);
        for (uint i = 0; i < count; ++i)
            check.compare_exact(found[i] == expected[i],
                                fmt::format("region {}{}", i, weighed ? ", weighed" : ""));
    }
    return check;
}

}  // namespace manylight

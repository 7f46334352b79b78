// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>

#include "reference/adaptive.hpp"
#include "verify/samplers/adaptive/run.hpp"
#include "verify/tolerances.hpp"

namespace manylight::adaptive_stages {

namespace {

// Whether a pixel's draws are those expected.
bool agree(const std::vector<DrawnNode>& found, const auto& expected) {
    return std::ranges::equal(found, expected, [](const DrawnNode& a, const auto& b) {
        return a.slot == b.slot && a.node == b.node &&
               std::abs(a.share - b.share) <= 1e-3 * b.share;
    });
}

}  // namespace

// The draws of the second pass, a group of pixels at a time.
Check check_weights(const Run& run, const LightTree& tree, const Scene& scene, const Viewers& view,
                    std::size_t most_entries) {
    Check check{.stage = "weights", .tolerance = node_tolerance};
    const std::size_t groups = pass_pixels(run.second) / run.lanes;
    const std::size_t stride =
        (groups * run.lanes * std::max<std::size_t>(run.sizes.empty() ? 1 : run.sizes[0], 16) /
         most_entries) |
        1;
    for (std::size_t group = 0; group < groups; group += stride) {
        const std::size_t tile =
            Run::item(run.second, run.lanes * group) / (std::size_t{ADAPTIVE_TILE} * ADAPTIVE_TILE);
        const std::vector<reference::DrawnPixel> pixels =
            group_of(run, view, run.lanes * group, true);
        const std::vector<reference::NodeDraws> expected = reference::draw_nodes(
            tree, scene, std::span(run.nodes).subspan(tile * CUT_CAPACITY, run.sizes[tile]), pixels,
            run.budget);
        for (std::size_t lane = 0; lane < run.lanes; ++lane) {
            if (expected[lane].uncertain &&
                !agree(run.drawn[run.lanes * group + lane], expected[lane].draws)) {
                check.excuse(1);
                check.skip_borderline();
                continue;
            }
            const std::string name = fmt::format("pixel {} of the pass", run.lanes * group + lane);
            const auto& draws = expected[lane].draws;
            const std::vector<DrawnNode>& found = run.drawn[run.lanes * group + lane];
            const std::size_t count = found.size();
            check.compare_exact(count == draws.size(),
                                fmt::format("{}: {} draws, not {}", name, count, draws.size()));
            for (std::size_t i = 0; i < std::min(count, draws.size()); ++i) {
                check.compare_exact(
                    found[i].slot == draws[i].slot && found[i].node == draws[i].node,
                    fmt::format("{}, draw {}: node {}, not {}", name, i, found[i].node,
                                draws[i].node));
                check.compare(std::abs(found[i].share - draws[i].share), 1e-3 * draws[i].share,
                              fmt::format("{}, draw {}: share {}, not {}", name, i, found[i].share,
                                          draws[i].share));
            }
        }
    }
    return check;
}

}  // namespace manylight::adaptive_stages

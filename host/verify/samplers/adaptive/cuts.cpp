// SPDX-License-Identifier: MIT
#include "reference/cuts.hpp"

#include <algorithm>
#include <cmath>

#include "verify/samplers/adaptive/run.hpp"
#include "verify/tolerances.hpp"

namespace manylight::adaptive_stages {

Check check_cuts(const Run& run, const LightTree& tree, const Scene& scene,
                 const reference::Tracer& tracer, const Viewers& view, uint cut_size) {
    Check check{.stage = "cuts", .tolerance = "none, but for close calls"};
    for (uint tile = 0; tile < run.tiles.count; ++tile) {
        const reference::TileCut expected =
            reference::make_cut(tree, scene, tracer, view, run.tiles, tile, run.surfaces, cut_size,
                                PROBE_RAYS, run.sample.seed);
        // Whatever rounding does: every light is in one node, in order.
        uint next = 0;
        for (uint slot = 0; slot < run.sizes[tile]; ++slot) {
            const LightNode& node = tree.nodes[run.nodes[tile * CUT_CAPACITY + slot]];
            check.compare_exact(node.first == next, fmt::format("tile {}, slot {}", tile, slot));
            next = node.first + node.count;
        }
        check.compare_exact(next == tree.lights.size(),
                            fmt::format("tile {}: {} lights", tile, next));
        if (expected.uncertain) continue;
        check.compare_exact(
            run.sizes[tile] == expected.nodes.size(),
            fmt::format("tile {}: {} nodes, not {}", tile, run.sizes[tile], expected.nodes.size()));
        for (uint slot = 0; slot < std::min<std::size_t>(run.sizes[tile], expected.nodes.size());
             ++slot) {
            const std::size_t place = tile * CUT_CAPACITY + slot;
            check.compare_exact(run.nodes[place] == expected.nodes[slot],
                                fmt::format("tile {}, slot {}: node {}, not {}", tile, slot,
                                            run.nodes[place], expected.nodes[slot]));
            check.compare(std::abs(run.probes[place].passed - expected.probes[slot].passed) +
                              std::abs(run.probes[place].traced - expected.probes[slot].traced),
                          1e-4, fmt::format("tile {}, slot {}: probes", tile, slot));
        }
    }
    return check;
}

}  // namespace manylight::adaptive_stages

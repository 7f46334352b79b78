// SPDX-License-Identifier: MIT
// Stage visibility, step by step: what kernels/samplers/adaptive/visibility.cl computes.
#pragma once

#include <span>
#include <vector>

#include "reference/cuts.hpp"

namespace manylight::reference {

/// What is known of a tile's slots.
struct TileRays {
    std::vector<uint> nodes;   // [slot], the cut
    std::vector<Rays> totals;  // [slot], probes and all cells
};

/// [slot] a tile's totals with what the tiles beside, above and below it lend: their rays by the
/// share of each node's lights that it has in common with the slot's, 16 rays at most.
[[nodiscard]] std::vector<Rays> share_rays(const LightTree& tree, const Tiles& tiles, uint tile,
                                           std::span<const TileRays> all);

/// Stage visibility for one tile: [64 * slot + cell] V^, from what is known of the slots, and what
/// cells counted, [64 * slot + cell], cells in Morton order; negative as long as no ray has passed.
[[nodiscard]] std::vector<double> estimate_visibility(std::span<const Rays> shared,
                                                      std::span<const Rays> counts);

}  // namespace manylight::reference

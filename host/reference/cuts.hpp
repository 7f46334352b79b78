// SPDX-License-Identifier: MIT
// Stage cuts, step by step: what kernels/samplers/adaptive/cuts.cl computes.
#pragma once

#include <span>
#include <vector>

#include "reference/node_estimate.hpp"
#include "reference/tracing.hpp"
#include "shared/tiles.h"

namespace manylight::reference {

/// Shadow rays: how many, and how many passed.
struct Rays {
    double traced = 0;
    double passed = 0;
};

struct TileCut {
    std::vector<uint> nodes;   // [slot]
    std::vector<Rays> probes;  // [slot]
    bool uncertain = false;    // rounding may have made another one
};

/// Stage cuts for one tile of a run, numbered within it; `surfaces`: of the run's items.
[[nodiscard]] TileCut make_cut(const LightTree& tree, const Scene& scene, const Tracer& tracer,
                               const Viewers& view, const Tiles& tiles, uint tile,
                               std::span<const Surface> surfaces, uint cut_size, uint probe_rays,
                               uint seed);

}  // namespace manylight::reference

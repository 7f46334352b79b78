// SPDX-License-Identifier: MIT
// Sampler adaptive, step by step: what kernels/cuts.cl, visibility.cl and samplers/adaptive.cl
// compute.
#pragma once

#include <functional>

#include "reference/samples.hpp"
#include "shared/adaptive.h"

namespace manylight::reference {

/// A node's radiance reflected to the camera if nothing is in between, estimated from its
/// statistics: intensity x softened cosines / squared distance x BRDF towards its centre, cd/m2.
[[nodiscard]] glm::dvec3 node_estimate(const LightTree& tree, uint node, const Point& point);

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
                               const Camera& camera, const Tiles& tiles, uint tile,
                               std::span<const Surface> surfaces, uint cut_size, uint probe_rays,
                               uint seed);

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
/// cells counted, [64 * slot + cell], cells in Morton order.
[[nodiscard]] std::vector<double> estimate_visibility(std::span<const Rays> shared,
                                                      std::span<const Rays> counts);

struct Drawn {
    uint slot, node;
    double share;     // how often it is expected to be drawn
    double weight;    // root of the mean square of what a ray tells of it, luminance, cd/m2
    double estimate;  // luminance, cd/m2
};

/// What a pixel draws.
struct PixelDraws {
    std::vector<Drawn> nodes;  // all that it chooses from, in the trees' order
    std::vector<Drawn> draws;
    glm::dvec3 control{0};  // sum of V^ x estimate over all nodes, cd/m2
    double variance = 0;    // of the luminance, for one draw
    bool uncertain = false;
};

/// Where in [0, 1) a pixel's systematic draw starts, and what rounds the number of its draws; see
/// draw_start() in kernels/samplers/adaptive.cl.
struct Starts {
    double position, rounding;
};

[[nodiscard]] Starts draw_starts(uint x, uint y, const Pass& pass, uint pixel_sample, uint seed);

/// A pixel of those that are drawn together.
struct DrawnPixel {
    const Surface* surface;  // or none
    Starts starts;
    std::vector<double> visible;  // [slot] V^
};

/// Draws the nodes of pixels, which share what is refined: as many as the device has lanes.
[[nodiscard]] std::vector<PixelDraws> draw_nodes(const LightTree& tree, const Scene& scene,
                                                 const Camera& camera, std::span<const uint> cut,
                                                 std::span<const DrawnPixel> pixels,
                                                 const Budget& budget);

/// A light of a node.
struct Descent {
    uint light;  // in the tree's order
    double probability;
    bool uncertain = false;
};

/// Goes down from a node by the estimates of children; `u` decides the first step, `bits` the
/// others.
[[nodiscard]] Descent descend(const LightTree& tree, uint node, const Point& point, double u,
                              uint bits);

}  // namespace manylight::reference

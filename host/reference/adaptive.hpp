// SPDX-License-Identifier: MIT
// What sampler adaptive draws, step by step: what kernels/samplers/adaptive/adaptive.cl computes.
#pragma once

#include <span>
#include <vector>

#include "reference/node_estimate.hpp"
#include "reference/samples.hpp"
#include "shared/adaptive.h"

namespace manylight::reference {

struct Drawn {
    uint slot, node;
    double share;     // how often it is expected to be drawn
    double weight;    // root of the mean square of what a ray tells of it, luminance, cd/m2
    double estimate;  // luminance, cd/m2
};

/// What a pixel draws.
struct NodeDraws {
    std::vector<Drawn> nodes;  // all that it chooses from, in the trees' order
    std::vector<Drawn> draws;
    glm::dvec3 control{0};  // sum of V^ x estimate over all nodes, cd/m2
    double variance = 0;    // of the luminance, for one draw
    bool uncertain = false;
};

/// V^ in the control variate: none of what is believed hidden, of which it would be a guess.
[[nodiscard]] inline double known_visibility(double visible) {
    return visible < double{HIDDEN_VISIBILITY} ? 0 : visible;
}

/// Where in [0, 1) a pixel's systematic draw starts, and what rounds the number of its draws; see
/// draw_start() in kernels/samplers/adaptive/adaptive.cl.
struct Starts {
    double position, rounding;
};

[[nodiscard]] Starts draw_starts(uint x, uint y, const Pass& pass, uint pixel_sample, uint seed);

/// A pixel of those that are drawn together.
struct DrawnPixel {
    const Surface* surface;  // or none
    Viewer viewer;
    Starts starts;
    std::vector<double> visible;  // [slot] V^, negative where no ray has passed
};

/// Draws the nodes of pixels, which share what is refined: as many as the device has lanes.
[[nodiscard]] std::vector<NodeDraws> draw_nodes(const LightTree& tree, const Scene& scene,
                                                std::span<const uint> cut,
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

// SPDX-License-Identifier: MIT
// Why a pixel is noisy: what sampler adaptive knows there, beside what is true.
#pragma once

#include "reference/tracing.hpp"
#include "samplers/adaptive/adaptive.hpp"

namespace manylight {

/// A node of the light tree that a pixel's draws choose from.
struct InspectedNode {
    uint node;            // in LightTree::nodes
    double weight;        // luminance of its estimate without shadows x root of V^, cd/m2
    double visibility;    // V^ in the pixel's cell
    double draws;         // expected number in a pixel sample
    double contribution;  // luminance, shadows included, of all its lights: the truth, cd/m2
    uint facing;          // lights that would contribute if nothing were in between
    uint seen;            // lights that do contribute, areas by at least one of their points
    double noise;         // share of its draws in the pixel's variance
};

/// A pixel's centre.
struct PixelReport {
    glm::uvec2 pixel;     // from the top left
    uint tile;            // of ADAPTIVE_TILE^2 pixels, in row order
    Surface surface;      // position.w below 0: nothing is hit, and all else is empty
    Material material{};  // of the point, textures included
    uint cut_nodes = 0;
    uint cut_lights = 0;               // nodes of the cut that are one light
    uint area_points = 0;              // of each light with area
    std::vector<InspectedNode> nodes;  // as refined for the pixel, in the tree's order
    glm::dvec3 radiance{0};            // of all lights, reflected to the camera, cd/m2
    double count_noise = 0;  // share of the variance that is by their number; with all nodes': 1
    double variance = 0;     // of the luminance of a pixel sample here, by the draws, (cd/m2)^2

    [[nodiscard]] bool hit() const { return surface.position.w >= 0; }
    [[nodiscard]] double draws() const;  // of a pixel sample, expected
};

/// Evaluates every light at a pixel's centre by the scalar reference, a light with area by up to
/// 256 points (fewer where lights are many), and beside it what `knowledge` of the pixel's tile
/// makes of it. `tiles`: the whole image's. The variance is exact for the systematic draw of nodes
/// (its start is averaged over), and takes a node's several draws for independent.
[[nodiscard]] PixelReport inspect_pixel(const Scene& scene, const LightTree& tree,
                                        const Camera& camera, const Tiles& tiles, glm::uvec2 pixel,
                                        const TileKnowledge& knowledge);

}  // namespace manylight

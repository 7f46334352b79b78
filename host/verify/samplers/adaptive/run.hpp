// SPDX-License-Identifier: MIT
// What the checks of sampler adaptive's stages share: a run of all of them on some tiles, and what
// judges each by it.
#pragma once

#include <functional>
#include <vector>

#include "reference/adaptive.hpp"
#include "samplers/adaptive/adaptive_samples.hpp"
#include "verify/verify.hpp"

namespace manylight::adaptive_stages {

using reference::Viewers;

constexpr uint most_tiles = 9;
// Of what is made of estimates of nodes.
constexpr const char* node_tolerance = "1e-3 (some 100 operations, lobes narrower than 1e-3 rad)";

// Two passes over some tiles, the second of which has learned from the first.
struct Run {
    unsigned lanes;  // pixels that are drawn together
    Tiles tiles;
    Pass first{0, 8, 0, 0, 0, 2}, second{8, 8, 0, 0, 0, 2};
    Budget budget{4, 4, 1};
    PixelSample sample;
    std::vector<Surface> surfaces;
    std::vector<uint> nodes, sizes;  // the cuts'
    std::vector<Trials> probes;
    std::vector<std::vector<DrawnNode>> first_drawn, drawn;  // [pixel of the pass]
    std::size_t slots = 0;                                   // of a tile in what follows
    std::vector<uint> counts;                                // after the first pass
    std::vector<float> visible;                              // likewise
    std::vector<float4> estimates;

    Run(Device& device, const DeviceScene& scene, Tiles all, uint cut_size, uint seed,
        std::size_t first_point, const std::function<void(const std::vector<Surface>&)>& ready);

    // Where a slot's cell is in counts and visible.
    [[nodiscard]] std::size_t place(std::size_t tile, std::size_t slot, std::size_t cell) const {
        return ((4 * tile + cell / 16) * slots + slot) * 16 + cell % 16;
    }
    // The item of a pixel of a pass.
    [[nodiscard]] static std::size_t item(const Pass& pass, std::size_t pixel);
    [[nodiscard]] bool hit(std::size_t item) const {
        const glm::uvec2 at = item_pixel(tiles, item);
        return at.x < tiles.width && at.y < tiles.height && surfaces[item].position.w >= 0;
    }
};

// The pixels that are drawn together with pixel p of the second pass; `starts`: where their draws
// start, which matters to which nodes are drawn alone.
[[nodiscard]] std::vector<reference::DrawnPixel> group_of(const Run& run, const Viewers& view,
                                                          std::size_t p, bool starts);

// Of what runs before there is a tree.
[[nodiscard]] Check check_seen_lights(Verifier& verifier);

// Each stage's check. `most_entries`: of weights, or of estimates, that the reference evaluates.
[[nodiscard]] Check check_cuts(const Run& run, const LightTree& tree, const Scene& scene,
                               const reference::Tracer& tracer, const Viewers& view, uint cut_size);
[[nodiscard]] Check check_visibility(const Run& run, const LightTree& tree);
[[nodiscard]] Check check_weights(const Run& run, const LightTree& tree, const Scene& scene,
                                  const Viewers& view, std::size_t most_entries);
[[nodiscard]] Check check_samples(const Run& run, const LightTree& tree, const Scene& scene,
                                  const reference::Tracer& tracer, const Viewers& view,
                                  std::size_t most_entries);

}  // namespace manylight::adaptive_stages

// SPDX-License-Identifier: MIT
#include <algorithm>

#include "shared/adaptive.h"
#include "verify/sampler_checks.hpp"
#include "verify/samplers/adaptive/run.hpp"

namespace manylight {

std::vector<Check> check_adaptive(Verifier& verifier, uint cut_size) {
    if (verifier.lights().empty()) return {};
    const VerifyOptions& options = verifier.options();
    Tiles tiles = all_tiles(options.width, options.height, ADAPTIVE_TILE);
    tiles.first = tiles.count > adaptive_stages::most_tiles
                      ? (tiles.count - adaptive_stages::most_tiles) / 2
                      : 0;
    tiles.count -= tiles.first;
    const adaptive_stages::Run run(
        verifier.device(), verifier.tree_scene(), tiles, cut_size, options.seed, verifier.points(),
        [&](const std::vector<Surface>& points) { verifier.send_out(points); });
    verifier.keep_materials();
    const Scene& scene = verifier.scene();
    const LightTree& tree = verifier.tree();
    const reference::Tracer& tracer = verifier.tracer();
    const reference::Viewers& view = verifier.viewers();
    return {adaptive_stages::check_cuts(run, tree, scene, tracer, view, cut_size),
            adaptive_stages::check_visibility(run, tree),
            adaptive_stages::check_weights(run, tree, scene, view, 10 * options.most_entries),
            adaptive_stages::check_samples(run, tree, scene, tracer, view, options.most_entries)};
}

SamplerChecks checks_adaptive() {
    return {.stages = {"seen_lights", "cuts", "visibility", "weights", "samples"},
            .run = [](Verifier& verifier, const Sampler&) {
                // Half as many nodes as lights, so that some are groups.
                const std::size_t half = (verifier.lights().size() + 1) / 2;
                std::vector<Check> checks = check_adaptive(
                    verifier, static_cast<uint>(std::clamp<std::size_t>(half, 2, CUT_CAPACITY)));
                if (!checks.empty())
                    checks.insert(checks.begin(), adaptive_stages::check_seen_lights(verifier));
                return checks;
            }};
}

}  // namespace manylight

// SPDX-License-Identifier: MIT
#include "samplers/contribution_cached/contribution_cached.hpp"

#include <cmath>
#include <glm/trigonometric.hpp>

#include "shared/contribution_cached.h"

namespace manylight {

ContributionCached::ContributionCached(const SamplerContext& context)
    : ByContribution(context, defensive_shares, true,
                     "samplers/contribution_cached/contribution_cached.cl"),
      most_rows_(static_cast<uint>(context.parameter("rows"))),
      least_cosine_(static_cast<float>(std::cos(glm::radians(context.parameter("angle"))))),
      neighbours_(context.device, context.tiles, most_regions(context.clusters)) {
    tables_.set(neighbours_.tables()).set("most_rows", most_rows_);
}

void ContributionCached::begin(const Tiles& tiles, const Buffer<Surface>& surfaces, uint seed,
                               const RayCount& progress) {
    ByContribution::begin(tiles, surfaces, seed, progress);
    neighbours_.find(tiles, surfaces, clustering(), least_cosine_);
}

Footprint ContributionCached::footprint(const SamplerLoad& load) {
    Footprint out = ByContribution::footprint(load);
    out.tile += NeighbourStage::tile_bytes(most_regions(load.clusters));
    out.fixed += sizeof(uint);  // the end of the last tile's
    return out;
}

Sampler sampler_contribution_cached() {
    return {.name = "contribution-cached",
            .summary = "contribution-defensive from the rows of the nearest clusters, too",
            .color = "#bcbd22",
            .clusters = true,
            .large_batches = true,  // clusters of neighbouring tiles
            .parameters = {{"rows", 4, 1, MOST_NEIGHBOURS + 1, "clusters that a pixel draws from",
                            true},
                           {"angle", 30, 0, 180, "between their normals at most, degrees"}},
            .closed_form = "samplers/contribution_cached/contribution_cached.cl",
            .footprint = ContributionCached::footprint,
            .make = [](const SamplerContext& context) -> std::unique_ptr<LightSampler> {
                return std::make_unique<ContributionCached>(context);
            }};
}

}  // namespace manylight

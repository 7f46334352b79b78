// SPDX-License-Identifier: MIT
#include "samplers/contribution/contribution.hpp"

#include <algorithm>

namespace manylight {
namespace {

ClusterOptions with_rule(ClusterOptions options, bool weighed) {
    options.shadow.weighed = weighed;
    return options;
}

}  // namespace

ByContribution::ByContribution(const SamplerContext& context, const Shares& shares, bool weighed,
                               std::string_view file)
    : OneLight(context, file),
      options_(with_rule(context.clusters, weighed)),
      light_count_(static_cast<double>(context.lights.size())),
      clustering_(context.device, context.scene, options_, context.tiles),
      mixture_(mixture_of(shares, context.lights)) {
    tables_ = clustering_.tables();
}

// How many there will be shows only as clusters are made: half of the worst is taken for all.
double ByContribution::expected_begin_rays(const Tiles& tiles) const {
    return 0.5 * tiles.count * most_regions(options_) * light_count_;
}

void ByContribution::begin(const Tiles& tiles, const Buffer<Surface>& surfaces, uint /*seed*/,
                           const RayCount& progress) {
    clustering_.build(tiles, surfaces, progress);
    clustering_.normalise(mixture_);
}

std::size_t ByContribution::begin_rays() const {
    std::size_t rays = 0;
    for (const RowSum& total : clustering_.totals()) rays += total.facing_count;
    return rays;
}

std::size_t ByContribution::cluster_count() const {
    return static_cast<std::size_t>(std::ranges::count(clustering_.split(), 0u));
}

ClusterFacts ByContribution::cluster_facts() const {
    return {clustering_.item_rows(), clustering_.representatives(), clustering_.totals(),
            clustering_.split()};
}

Footprint ByContribution::footprint(const SamplerLoad& load) {
    Footprint out = OneLight::footprint(load);
    out.tile += Clustering::tile_bytes(load.clusters, load.lights);
    out.fixed = ContributionStage::ray_bytes(load.lights);
    out.tile_matrix = most_regions(load.clusters) * Matrix::row_bytes(load.lights);
    return out;
}

Sampler sampler_contribution() {
    return {.name = "contribution",
            .summary =
                "by contribution to the cluster's representative, shadows included (the paper's)",
            .color = "#ff7f0e",
            .biased = true,
            .clusters = true,
            .closed_form = "samplers/contribution/contribution.cl",
            .footprint = ByContribution::footprint,
            .make = [](const SamplerContext& context) -> std::unique_ptr<LightSampler> {
                return std::make_unique<ByContribution>(context, paper_shares, false);
            }};
}

Sampler sampler_contribution_defensive() {
    return {.name = "contribution-defensive",
            .summary = "the paper's, mixed with unshadowed contribution and power",
            .color = "#e377c2",
            .clusters = true,
            .closed_form = "samplers/contribution/contribution.cl",
            .footprint = ByContribution::footprint,
            .make = [](const SamplerContext& context) -> std::unique_ptr<LightSampler> {
                return std::make_unique<ByContribution>(context, defensive_shares, true);
            }};
}

}  // namespace manylight

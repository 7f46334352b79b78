// SPDX-License-Identifier: MIT
#pragma once

#include "samplers/contribution/clustering.hpp"
#include "samplers/one_light/one_light.hpp"

namespace manylight {

/// How the paper's own sampler mixes its rows, and the defensive one.
constexpr Shares paper_shares = {.visible = 1};
constexpr Shares defensive_shares = {.visible = 0.4f, .unshadowed = 0.5f, .power = 0.1f};

/// A sampler that draws from a CDF per cluster of pixels, made of the contribution matrix: the
/// paper's.
class ByContribution : public OneLight {
  public:
    /// `weighed`: see ShadowRule. `file`: below kernels/, draws from the clustering's tables.
    ByContribution(const SamplerContext& context, const Shares& shares, bool weighed,
                   std::string_view file = "samplers/contribution/contribution.cl");

    [[nodiscard]] double expected_begin_rays(const Tiles& tiles) const override;
    void begin(const Tiles& tiles, const Buffer<Surface>& surfaces, uint seed,
               const RayCount& progress) override;
    [[nodiscard]] std::size_t begin_rays() const override;
    [[nodiscard]] std::size_t cluster_count() const override;
    [[nodiscard]] ClusterFacts cluster_facts() const override;

    [[nodiscard]] static Footprint footprint(const SamplerLoad& load);

    /// The last batch's.
    [[nodiscard]] const Clustering& clustering() const { return clustering_; }

  private:
    ClusterOptions options_;
    double light_count_;
    Clustering clustering_;
    Mixture mixture_;
};

}  // namespace manylight

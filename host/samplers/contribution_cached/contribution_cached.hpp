// SPDX-License-Identifier: MIT
#pragma once

#include "samplers/contribution/contribution.hpp"
#include "samplers/contribution_cached/neighbours.hpp"

namespace manylight {

/// Importance caching: contribution-defensive, whose pixels draw from the rows of the clusters
/// about them, too.
class ContributionCached : public ByContribution {
  public:
    explicit ContributionCached(const SamplerContext& context);

    void begin(const Tiles& tiles, const Buffer<Surface>& surfaces, uint seed,
               const RayCount& progress) override;

    [[nodiscard]] uint most_rows() const { return most_rows_; }         // of a pixel
    [[nodiscard]] float least_cosine() const { return least_cosine_; }  // of neighbours' normals

    [[nodiscard]] static Footprint footprint(const SamplerLoad& load);

  private:
    uint most_rows_;
    float least_cosine_;
    NeighbourStage neighbours_;
};

}  // namespace manylight

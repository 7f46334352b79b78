// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "output/error_estimate.hpp"
#include "pipeline/aov.hpp"
#include "pipeline/plan.hpp"
#include "scene/scene.hpp"

namespace manylight {

/// The layers of a frame that were asked for, and the number of its clusters, which are counted
/// over batches.
class Layers {
  public:
    /// `scene` and `options` live longer.
    Layers(const Scene& scene, const RenderOptions& options, const Plan& plan);

    /// Keeps what is known of a batch, if it is not kept yet: its materials, its surfaces at the
    /// pixels' centres, and its clusters, where the plan has some. `sampler`: null without lights.
    void keep(unsigned number, const Tiles& batch, const Buffer<Material>& materials,
              const Buffer<Surface>& centres, const LightSampler* sampler);

    /// Fills layer `error`.
    void keep_error(const std::optional<ErrorEstimate>& error);

    /// Of all batches that are kept.
    [[nodiscard]] std::size_t clusters() const { return clusters_; }

    /// By name, in the order of all_aovs().
    [[nodiscard]] std::vector<std::pair<std::string, Image>> take() { return std::move(layers_); }

  private:
    const Scene& scene_;
    bool has_clusters_;
    std::vector<std::pair<std::string, Image>> layers_;
    std::vector<bool> kept_;  // [batch]
    std::size_t clusters_ = 0;
};

}  // namespace manylight

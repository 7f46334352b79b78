// SPDX-License-Identifier: MIT
#pragma once

#include "samplers/one_light/one_light.hpp"

namespace manylight {

/// Stochastic lightcuts: a cut of the light tree at each pixel, and a light of each node.
class StochasticLightcuts : public OneLight {
  public:
    explicit StochasticLightcuts(const SamplerContext& context);

    /// Nodes of a cut, at most.
    [[nodiscard]] uint cut_nodes() const { return cut_nodes_; }

  private:
    uint cut_nodes_;
};

}  // namespace manylight

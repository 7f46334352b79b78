// SPDX-License-Identifier: MIT
#pragma once

#include "light_tree/light_tree.hpp"
#include "reference/samples.hpp"

namespace manylight::reference {

/// Down the light tree by the importance of its nodes.
class DownLightTree : public OneLight {
  public:
    /// Keeps the reference.
    explicit DownLightTree(const LightTree& tree) : tree_(tree) {}
    [[nodiscard]] Choice choose(const Point& point, const Draw& draw) const override;
    [[nodiscard]] std::optional<double> probability(const Point& point, std::size_t item,
                                                    uint light) const override;

  private:
    const LightTree& tree_;
};

}  // namespace manylight::reference

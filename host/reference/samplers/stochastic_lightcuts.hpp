// SPDX-License-Identifier: MIT
// Sampler stochastic-lightcuts, step by step: what its kernel computes.
#pragma once

#include <vector>

#include "light_tree/light_tree.hpp"
#include "reference/samples.hpp"

namespace manylight::reference {

/// Nodes of the light tree, in its order, that together hold every light that may shine on a point.
struct LightCut {
    std::vector<uint> nodes;  // BOTH_ROOTS: that above both roots
    bool doubtful = false;    // rounding may have made another one
};

/// The cut of up to `size` nodes, at least 1: from the root on the node with the largest bound is
/// split (Yuksel, "Stochastic Lightcuts", 2019).
[[nodiscard]] LightCut light_cut(const LightTree& tree, const Surface& surface, uint size);

/// The bound that splits a node: of the illuminance by its lights, lx, with the distance no shorter
/// than the bounds' radius.
[[nodiscard]] double illuminance_bound(const LightNode& node, const Surface& surface);

class StochasticLightcuts : public OneLight {
  public:
    /// Keeps the reference. `cut_nodes`: of a cut, at most.
    StochasticLightcuts(const LightTree& tree, uint cut_nodes)
        : tree_(tree), cut_nodes_(cut_nodes) {}

    [[nodiscard]] Choice choose(const Point& point, const Draw& draw) const override;

    /// Of one light sample for the pixel, whose cut is the root.
    [[nodiscard]] std::optional<double> probability(const Point& point, std::size_t item,
                                                    uint light) const override;

    [[nodiscard]] std::optional<ExpectedCount> expected_count(const Point& point, std::size_t item,
                                                              uint light,
                                                              uint sample_count) const override;

  private:
    // The probability that a draw from a node that holds a light is of it.
    [[nodiscard]] double probability_from(uint node, uint light, const Surface& surface) const;

    const LightTree& tree_;
    uint cut_nodes_;
};

}  // namespace manylight::reference

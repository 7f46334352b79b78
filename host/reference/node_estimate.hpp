// SPDX-License-Identifier: MIT
// What a light tree's node contributes: what kernels/lib/node_estimate.h computes.
#pragma once

#include "light_tree/light_tree.hpp"
#include "reference/samples.hpp"

namespace manylight::reference {

/// Difference in a decision by estimates that single precision may not see, relative.
constexpr double doubtful = 1e-4;

/// A node's second child; the first is the next node.
[[nodiscard]] uint right_child(const LightTree& tree, uint node);

/// A node's radiance reflected to the camera if nothing is in between, estimated from its
/// statistics: intensity x softened cosines / squared distance x BRDF towards its centre, cd/m2.
[[nodiscard]] glm::dvec3 node_estimate(const LightTree& tree, uint node, const Point& point);

/// By how much rounding of a point's height over the plane of a light with area changes the
/// luminance of node_estimate(), cd/m2.
[[nodiscard]] double estimate_rounding(const LightTree& tree, uint node, const Point& point);

}  // namespace manylight::reference

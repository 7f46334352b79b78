// SPDX-License-Identifier: MIT
#pragma once

#include "shared/light_tree.h"
#include "shared/surface.h"

namespace manylight::reference {

/// How a surface point sees a node's lights.
struct NodeView {
    /// The most favourable cosines of normal and emission, multiplied; 0 where none of the lights
    /// shines on the point. Of directional lights the normal's alone.
    double cosines = 0;
    double distance = 0, radius = 0;  // of the sphere around the bounds, m; of finite lights
    bool doubtful = false;            // rounding may decide whether the cosines are 0
    double slack = 0;                 // what rounding may do to them, relative
};
[[nodiscard]] NodeView view_node(const LightNode& node, const Surface& surface);

/// pbrt-v4's importance of a node's lights to a surface (LightBounds::Importance): power x the most
/// favourable cosines / squared distance, which counts as the bounds' radius at least. For
/// directional lights: illuminance x the most favourable cosine.
[[nodiscard]] double importance(const LightNode& node, const Surface& surface);

}  // namespace manylight::reference

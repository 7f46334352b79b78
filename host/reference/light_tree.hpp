// SPDX-License-Identifier: MIT
#pragma once

#include "shared/light_tree.h"
#include "shared/surface.h"

namespace manylight::reference {

/// pbrt-v4's importance of a node's lights to a surface (LightBounds::Importance): power x the most
/// favourable cosines / squared distance, which counts as the bounds' radius at least. For
/// directional lights: illuminance x the most favourable cosine.
[[nodiscard]] double importance(const LightNode& node, const Surface& surface);

}  // namespace manylight::reference

// SPDX-License-Identifier: MIT
#pragma once

#include <span>

#include "shared/surface.h"
#include "shared/tiles.h"

namespace manylight::reference {

/// Stage representatives: the item of a region's centre pixel, or of the hit pixel nearest to it
/// (first in row order) where it missed the scene, or NO_ITEM. surfaces[item].
[[nodiscard]] uint representative(const Tiles& tiles, std::span<const Surface> surfaces,
                                  const Region& region);

}  // namespace manylight::reference

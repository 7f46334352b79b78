// SPDX-License-Identifier: MIT
#pragma once

#include <span>
#include <vector>

#include "shared/surface.h"
#include "shared/tiles.h"

namespace manylight::reference {

/// Stage clusters: whether each region is to be split, by the normals at its corner pixels.
/// surfaces[item].
[[nodiscard]] std::vector<uint> split_by_normals(const Tiles& tiles,
                                                 std::span<const Surface> surfaces,
                                                 std::span<const Region> regions,
                                                 float cos_threshold, uint max_level);

/// [item] the region without split mark that each pixel lies in; ~0 where there is none.
[[nodiscard]] std::vector<uint> assign_rows(const Tiles& tiles, std::span<const Region> regions,
                                            std::span<const uint> split);

}  // namespace manylight::reference

// SPDX-License-Identifier: MIT
#pragma once

#include <span>
#include <vector>

#include "shared/contribution.h"
#include "shared/tiles.h"

namespace manylight::reference {

/// Stage refinement: whether each region is to be split for its visibility. totals[region].
/// `weighed`: lights count by their contribution without visibility, not all alike.
[[nodiscard]] std::vector<uint> split_by_visibility(std::span<const Region> regions,
                                                    std::span<const RowSum> totals, bool weighed,
                                                    float threshold, uint max_level);

}  // namespace manylight::reference

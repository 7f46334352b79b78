// SPDX-License-Identifier: MIT
#pragma once

#include "device/device.hpp"
#include "shared/contribution.h"
#include "stages/tiles.hpp"

namespace manylight {

/// Stage refinement: which clusters in shadow are split (paper 4.1, umbra and penumbra).
class RefinementStage {
  public:
    explicit RefinementStage(Device& device);

    /// split[region], for regions first to first + count, from their representatives' totals: 1
    /// where the region is in shadow (sees less than `threshold` of the lights that face it), is
    /// above `max_level` and is no umbra (all siblings of a visibility split in shadow).
    void split(const Buffer<Region>& regions, const Buffer<RowSum>& totals, uint first, uint count,
               float threshold, uint max_level, Buffer<uint>& split);

  private:
    Kernel split_;
};

}  // namespace manylight

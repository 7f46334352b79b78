// SPDX-License-Identifier: MIT
#pragma once

#include "device/device.hpp"
#include "shared/contribution.h"
#include "stages/tiles.hpp"

namespace manylight {

/// Below which share of the lights that face a representative its cluster is in shadow.
struct ShadowRule {
    bool weighed = false;  // lights count by what they would contribute; false: all alike (paper)
    float threshold = 0.7f;
};

/// Stage refinement: which clusters in shadow are split (paper 4.1, umbra and penumbra).
class RefinementStage {
  public:
    explicit RefinementStage(Device& device);

    /// split[region], for regions first to first + count, from their representatives' totals: 1
    /// where the region is in shadow, is above `max_level` and is no umbra (all siblings of a
    /// visibility split in shadow).
    void split(const Buffer<Region>& regions, const Buffer<RowSum>& totals, uint first, uint count,
               const ShadowRule& rule, uint max_level, Buffer<uint>& split);

  private:
    Kernel split_;
};

}  // namespace manylight

// SPDX-License-Identifier: MIT
#pragma once

#include "device/device.hpp"
#include "shared/surface.h"
#include "stages/tiles.hpp"

namespace manylight {

/// Stage representatives: the pixel that stands for each region (paper 4.1).
class RepresentativeStage {
  public:
    explicit RepresentativeStage(Device& device);

    /// representatives[region], for regions first to first + count: the item of the centre pixel,
    /// or of the hit pixel nearest to it where it missed the scene, or NO_ITEM.
    void pick(const Tiles& tiles, const Buffer<Surface>& surfaces, const Buffer<Region>& regions,
              uint first, uint count, Buffer<uint>& representatives);

  private:
    Kernel pick_;
};

}  // namespace manylight

// SPDX-License-Identifier: MIT
#pragma once

#include "shared/surface.h"
#include "stages/device_scene.hpp"
#include "stages/tiles.hpp"

namespace manylight {

/// Which sample of each pixel a pass takes.
struct PixelSample {
    uint index = 0;
    uint seed = 0;
    bool jitter = false;  // false: at the pixel's centre
};

/// Stage gbuffer: one primary ray per pixel.
class GBufferStage {
  public:
    GBufferStage(Device& device, const DeviceScene& scene);

    /// surfaces[item] for every item of `tiles` that is in the image.
    void trace(const Tiles& tiles, const PixelSample& sample, Buffer<Surface>& surfaces);

  private:
    Arguments scene_;
    Kernel trace_;
    std::size_t rays_per_item_;
};

}  // namespace manylight

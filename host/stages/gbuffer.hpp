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

    /// What tells a ray from the same one of another sample (kernels/lib/alpha.h).
    [[nodiscard]] uint salt() const { return seed * 0x9e3779b9u + index + 1; }
};

/// Stage gbuffer: one primary ray per pixel.
class GBufferStage {
  public:
    GBufferStage(Device& device, const DeviceScene& scene);

    /// surfaces[item] for every item of `tiles` that is in the image. Where the scene varies
    /// materials, that of item i is point first_point + i of those that upload_scene() was told.
    void trace(const Tiles& tiles, const PixelSample& sample, Buffer<Surface>& surfaces,
               std::size_t first_point = 0);

  private:
    Arguments scene_;
    Buffer<Material> materials_;
    uint own_materials_;
    bool varies_materials_;
    Kernel trace_;
    std::size_t rays_per_item_;
};

}  // namespace manylight

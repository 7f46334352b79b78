// SPDX-License-Identifier: MIT
#pragma once

#include "shared/surface.h"
#include "stages/device_scene.hpp"
#include "stages/tiles.hpp"

namespace manylight {

/// Stage accumulate: pixel samples to the image.
class AccumulateStage {
  public:
    AccumulateStage(Device& device, const DeviceScene& scene);

    /// image[y * width + x] += estimates[item], with what the surface emits to the camera in rgb.
    void add(const Tiles& tiles, const Buffer<Surface>& surfaces, const Buffer<float4>& estimates,
             Buffer<float4>& image);

  private:
    Arguments scene_;
    Kernel add_;
};

}  // namespace manylight

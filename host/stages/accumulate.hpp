// SPDX-License-Identifier: MIT
#pragma once

#include "shared/surface.h"
#include "stages/device_scene.hpp"
#include "stages/tiles.hpp"

namespace manylight {

/// The image's sums over pixel samples, [y * width + x]: rgb, radiance, cd/m2; w, shadow rays.
struct ImageSum {
    Buffer<float4> sums;
    Buffer<float4> residuals;  // of the sums, see kernels/lib/sum.h
};

/// Stage accumulate: pixel samples to the image.
class AccumulateStage {
  public:
    AccumulateStage(Device& device, const DeviceScene& scene);

    /// Adds estimates[item], and to rgb what the surface emits to the camera.
    void add(const Tiles& tiles, const Buffer<Surface>& surfaces, const Buffer<float4>& estimates,
             ImageSum& image);

  private:
    Arguments scene_;
    Kernel add_;
};

}  // namespace manylight

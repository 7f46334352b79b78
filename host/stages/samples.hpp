// SPDX-License-Identifier: MIT
#pragma once

#include <functional>

#include "shared/surface.h"
#include "stages/device_scene.hpp"
#include "stages/gbuffer.hpp"

namespace manylight {

/// A batch's estimates, [item]: rgb, of the direct illumination reflected to the camera, cd/m2; w,
/// the number of shadow rays.
struct Estimates {
    Buffer<float4> sums;
    Buffer<float4> residuals;  // of the sums, see kernels/lib/sum.h
};

/// Stage samples: N light samples for each pixel sample (paper (2)), or all lights (paper (1)).
class SampleStage {
  public:
    /// `file`: the sampler's kernel file. A launch draws as many samples of all items as come to
    /// about `per_launch`, but at least one.
    SampleStage(Device& device, const DeviceScene& scene, std::string_view file,
                std::size_t per_launch = std::size_t{1} << 22);

    /// Fills the estimates of `tiles`. `tables` names the buffers that the sampler needs.
    /// `progress` is called with the light samples done, over all items, after each launch.
    void draw(const Tiles& tiles, const PixelSample& sample, uint light_samples,
              const Buffer<Surface>& surfaces, const Arguments& tables, Estimates& estimates,
              const std::function<void(std::size_t)>& progress);

  private:
    Arguments scene_;
    Kernel draw_;
    std::size_t per_launch_;
};

}  // namespace manylight

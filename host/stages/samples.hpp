// SPDX-License-Identifier: MIT
#pragma once

#include <functional>

#include "shared/surface.h"
#include "stages/device_scene.hpp"
#include "stages/gbuffer.hpp"

namespace manylight {

/// Stage samples: N light samples for each pixel sample (paper (2)), or all lights (paper (1)).
class SampleStage {
  public:
    /// `file`: the sampler's kernel file.
    SampleStage(Device& device, const DeviceScene& scene, std::string_view file);

    /// estimates[item]: rgb, the estimate of the direct illumination reflected to the camera,
    /// cd/m2; w, the number of shadow rays. `tables` names the buffers that the sampler needs.
    /// `progress` is called with the light samples done, over all items, after each launch.
    void draw(const Tiles& tiles, const PixelSample& sample, uint light_samples,
              const Buffer<Surface>& surfaces, const Arguments& tables, Buffer<float4>& estimates,
              const std::function<void(std::size_t)>& progress);

  private:
    Arguments scene_;
    Kernel draw_;
};

}  // namespace manylight

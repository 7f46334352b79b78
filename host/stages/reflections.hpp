// SPDX-License-Identifier: MIT
#pragma once

#include "shared/surface.h"
#include "stages/device_scene.hpp"
#include "stages/gbuffer.hpp"

namespace manylight {

/// Stage reflections: area lights as glossy surfaces reflect them, by one ray per pixel sample
/// drawn from the GGX lobe. Only for scenes that need it, see DeviceScene::reflections.
class ReflectionStage {
  public:
    ReflectionStage(Device& device, const DeviceScene& scene);

    /// Adds to the rgb of estimates[item], cd/m2, what the light samples leave to this stage.
    void add(const Tiles& tiles, const PixelSample& sample, const Buffer<Surface>& surfaces,
             Buffer<float4>& estimates);

  private:
    Arguments scene_;
    Kernel add_;
};

}  // namespace manylight

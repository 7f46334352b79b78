// SPDX-License-Identifier: MIT
#pragma once

#include <string_view>

#include "shared/reflected.h"
#include "shared/surface.h"
#include "stages/device_scene.hpp"
#include "stages/gbuffer.hpp"

namespace manylight {

/// Stage reflections: area lights as glossy surfaces reflect them, by one ray per pixel sample
/// drawn from the GGX lobe. Only for scenes that need it, see DeviceScene::reflections.
class ReflectionStage {
  public:
    /// For up to `items` items. `closed_form`: the row's of the sampler that draws the light
    /// samples.
    ReflectionStage(Device& device, const DeviceScene& scene, std::size_t items,
                    std::string_view closed_form = {});

    /// Adds to the rgb of estimates[item], cd/m2, what `light_samples` light samples of the item,
    /// drawn from `tables`, leave to this stage.
    void add(const Tiles& tiles, const PixelSample& sample, uint light_samples,
             const Buffer<Surface>& surfaces, const Arguments& tables, Buffer<float4>& estimates);

    /// The same where `reflected` says what the rays of the items have met.
    void add_reflected(const Tiles& tiles, uint light_samples, const Buffer<Surface>& surfaces,
                       const Arguments& tables, const Buffer<Reflected>& reflected,
                       Buffer<float4>& estimates);

    /// Bytes of an item on the device.
    [[nodiscard]] static constexpr std::size_t item_bytes() { return sizeof(Reflected); }

  private:
    Arguments scene_;
    Kernel trace_;
    Kernel add_;
    Buffer<Reflected> reflected_;
};

}  // namespace manylight

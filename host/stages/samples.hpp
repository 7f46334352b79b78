// SPDX-License-Identifier: MIT
#pragma once

#include <functional>

#include "shared/adaptive.h"
#include "shared/surface.h"
#include "stages/device_scene.hpp"
#include "stages/gbuffer.hpp"
#include "stages/shadows.hpp"

namespace manylight {

/// A batch's estimates, [item]: rgb, of the direct illumination reflected to the camera, cd/m2; w,
/// the number of shadow rays.
struct Estimates {
    Buffer<float4> sums;
    Buffer<float4> residuals;  // of the sums, see kernels/lib/sum.h
};

/// Pixels of a pass over its tiles.
[[nodiscard]] inline std::size_t pass_pixels(const Pass& pass) {
    return std::size_t{pass.tile_count} * CELLS_PER_TILE * pass.count;
}

/// Stage samples: N light samples for each pixel sample (paper (2)), or all lights (paper (1)).
class SampleStage {
  public:
    /// `file`: the sampler's kernel file. For up to `items` items, 16 samples of each at a time.
    SampleStage(Device& device, const DeviceScene& scene, std::string_view file, std::size_t items);

    /// Fills the estimates of `tiles`. `tables` names the buffers that the sampler needs.
    /// `progress` is called with the light samples done, over all items, after each launch, and
    /// says whether to go on. Returns false where that left samples undone.
    bool draw(const Tiles& tiles, const PixelSample& sample, uint light_samples,
              const Buffer<Surface>& surfaces, const Arguments& tables, Estimates& estimates,
              const std::function<bool(std::size_t)>& progress);

    /// Bytes of an item on the device.
    [[nodiscard]] static constexpr std::size_t item_bytes() {
        return ShadowStage::packet_bytes() + 48 * sizeof(float);
    }

  private:
    Arguments scene_;
    ShadowStage shadows_;
    Kernel draw_;
    Kernel add_;
    Buffer<float> values_;  // [48 * item + 16 * channel + lane], see kernels/lib/samples.h
};

}  // namespace manylight

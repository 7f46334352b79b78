// SPDX-License-Identifier: MIT
#pragma once

#include <optional>

#include "shared/adaptive.h"
#include "shared/groups.h"
#include "shared/surface.h"
#include "stages/device_scene.hpp"
#include "stages/tiles.hpp"

namespace manylight {

/// The image's sums over pixel samples, [y * width + x].
struct ImageSum {
    /// All zero. `grouped`: whether the error is to be estimated.
    ImageSum(Device& device, std::size_t pixels, bool grouped);

    Buffer<float4> sums;       // rgb: weighted radiance, cd/m2; w: shadow rays
    Buffer<float4> residuals;  // of the sums, see kernels/lib/sum.h
    Buffer<float> weights;
    Buffer<float4> groups;  // of samples, see estimate_error(); nothing where no error is estimated

    [[nodiscard]] static constexpr std::size_t pixel_bytes(bool grouped) {
        return (grouped ? 2 + ERROR_GROUPS : 2) * sizeof(float4) + sizeof(float);
    }
};

/// How a sample of a pixel counts.
struct SampleWeight {
    float weight = 1;
    uint group = 0;
};

/// Stage accumulate: pixel samples to the image.
class AccumulateStage {
  public:
    AccumulateStage(Device& device, const DeviceScene& scene, bool grouped);

    /// Adds estimates[item], and to rgb what the surface emits to the camera: of all pixels of
    /// `tiles`, or of a pass over them. `seen`: what stage emitter_parts has found, where the
    /// scene on the device has it.
    void add(const Tiles& tiles, const std::optional<Pass>& pass, const Buffer<Surface>& surfaces,
             const Buffer<float4>& estimates, const Buffer<float4>& seen, SampleWeight weight,
             ImageSum& image);

  private:
    Arguments scene_;
    bool grouped_;
    Kernel add_;
    Kernel add_pass_;
};

}  // namespace manylight

// SPDX-License-Identifier: MIT
#pragma once

#include <optional>

#include "shared/adaptive.h"
#include "shared/surface.h"
#include "stages/device_scene.hpp"
#include "stages/tiles.hpp"

namespace manylight {

/// The image's sums over pixel samples, [y * width + x].
struct ImageSum {
    /// All zero. `pairs`: whether the error is to be estimated.
    ImageSum(Device& device, std::size_t pixels, bool pairs);

    Buffer<float4> sums;       // rgb: weighted radiance, cd/m2; w: shadow rays
    Buffer<float4> residuals;  // of the sums, see kernels/lib/sum.h
    Buffer<float> weights;
    // Samples 2 k and 2 k + 1 are a pair of equal weight; nothing where no error is estimated.
    Buffer<float4> pending;      // the first of a pair, weighted
    Buffer<float4> differences;  // rgb: over pairs, weighted; w: their weights

    [[nodiscard]] static constexpr std::size_t pixel_bytes(bool pairs) {
        return (pairs ? 4 : 2) * sizeof(float4) + sizeof(float);
    }
};

/// How a sample of a pixel counts.
struct SampleWeight {
    float weight = 1;
    bool odd = false;  // whether its number is
};

/// Stage accumulate: pixel samples to the image.
class AccumulateStage {
  public:
    AccumulateStage(Device& device, const DeviceScene& scene, bool pairs);

    /// Adds estimates[item], and to rgb what the surface emits to the camera: of all pixels of
    /// `tiles`, or of a pass over them.
    void add(const Tiles& tiles, const std::optional<Pass>& pass, const Buffer<Surface>& surfaces,
             const Buffer<float4>& estimates, SampleWeight weight, ImageSum& image);

  private:
    Arguments scene_;
    bool pairs_;
    Kernel add_;
    Kernel add_pass_;
};

}  // namespace manylight

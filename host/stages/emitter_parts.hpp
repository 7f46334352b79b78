// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "shared/emitter_part.h"
#include "stages/device_scene.hpp"
#include "stages/gbuffer.hpp"
#include "stages/tiles.hpp"

namespace manylight {

/// What pixels see of emissive triangles that cover them in part.
struct EmitterParts {
    std::vector<EmitterPart> parts;  // by pixel, and there by triangle
    std::vector<uint> pixel_parts;   // of pixel p: parts [pixel_parts[p], pixel_parts[p + 1])
    // Each is drawn in every stride-th pixel sample, so that these draw no more parts than the
    // image has pixels.
    uint stride = 1;

    [[nodiscard]] bool empty() const { return parts.empty(); }
    /// The most that a pixel sample draws.
    [[nodiscard]] std::size_t drawn() const { return (parts.size() + stride - 1) / stride; }
    /// On the device, with what EmitterPartStage keeps.
    [[nodiscard]] std::size_t bytes() const;
};

/// The parts of all emissive triangles that face the camera, as if nothing were in their way, in an
/// image of width x height pixels, between the near and the far plane. Left to the pixels' own rays
/// are triangles of instances, of unlit materials and those of which not all is there, and in each
/// pixel those that cover nearly all of it, or more than 1 / stride.
[[nodiscard]] EmitterParts find_emitter_parts(const Scene& scene, const Camera& camera,
                                              unsigned width, unsigned height);

/// Stage emitter_parts: what the camera sees of such parts.
class EmitterPartStage {
  public:
    /// `found` is of the image that the tiles will be of, and not empty.
    EmitterPartStage(Device& device, const DeviceScene& scene, const EmitterParts& found);

    /// seen[item].rgb: what the parts add to a pixel sample, cd/m2; .w: 0 or 1, the part of what
    /// its own ray has met that counts.
    void trace(const Tiles& tiles, const PixelSample& sample, const Buffer<Surface>& surfaces,
               Buffer<float4>& seen);

    /// Of the last trace(): light()[t].rgb, cd/m2, is what part first() + stride t gives its pixel,
    /// if that is one of the tiles'.
    [[nodiscard]] const Buffer<float4>& light() const { return light_; }
    [[nodiscard]] uint first() const { return first_; }

  private:
    Arguments scene_;
    uint stride_;
    uint first_ = 0;
    Kernel draw_;
    Kernel gather_;
    Buffer<float4> light_;
};

}  // namespace manylight

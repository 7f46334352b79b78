// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "stages/device_scene.hpp"
#include "stages/gbuffer.hpp"

namespace manylight {

/// Stage seen_lights: a first look at which lights shine on anything that the image shows.
class SeenLightsStage {
  public:
    /// Points of the image that the look is from, pixels of an image of points_side^2.
    static constexpr unsigned points_side = 32;

    SeenLightsStage(Device& device, const DeviceScene& scene);

    /// Shadow rays to each light, at most, where an image of so many pixels can spare them; or 0.
    [[nodiscard]] static uint rays_per_light(std::size_t lights, std::size_t pixels);

    /// [light]: whether any of `rays` shadow rays from points of the image reaches it.
    [[nodiscard]] std::vector<bool> find(uint rays, uint seed);

  private:
    Device& device_;
    GBufferStage gbuffer_;
    Arguments scene_;
    uint light_count_;
    Kernel find_;
};

}  // namespace manylight

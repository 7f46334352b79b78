// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "stages/device_scene.hpp"
#include "stages/gbuffer.hpp"

namespace manylight {

/// Stage seen_lights: which lights anything sees that the image shows. A first look, by a few
/// shadow rays from as many pixels to each light: what it says only orders the lights.
class SeenLightsStage {
  public:
    /// The look is from the pixels of an image of points_side x points_side.
    static constexpr unsigned points_side = 32;
    [[nodiscard]] static Tiles points() { return all_tiles(points_side, points_side, points_side); }

    /// `scene` has room for the points' materials (see upload_scene()). `rays`: to each light at
    /// most.
    SeenLightsStage(Device& device, const DeviceScene& scene, uint rays);

    /// What the pixels show: [item] of points().
    [[nodiscard]] Buffer<Surface> look(uint seed);

    /// [light], in the order that they have on the device: whether any of its rays passes.
    [[nodiscard]] std::vector<bool> find(const Buffer<Surface>& surfaces, uint seed);

    /// Bytes on the device for both.
    [[nodiscard]] static std::size_t bytes(std::size_t lights) {
        return item_count(points()) * sizeof(Surface) + lights * sizeof(uint);
    }

  private:
    Device& device_;
    GBufferStage gbuffer_;
    Arguments scene_;
    uint light_count_;
    uint rays_;
    Kernel find_;
};

}  // namespace manylight

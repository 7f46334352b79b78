// SPDX-License-Identifier: MIT
#pragma once

#include "stages/device_scene.hpp"

namespace manylight {

/// Stage shadows: which of many rays something is in the way of. Other stages fill its buffers,
/// packets of 16 rays with one origin (layout: kernels/lib/rays.h), and read the result there.
class ShadowStage {
  public:
    /// Holds up to `packets` packets.
    ShadowStage(Device& device, const DeviceScene& scene, std::size_t packets);

    /// The buffers, as kernels' arguments origins and rays.
    [[nodiscard]] Arguments buffers() const;

    /// The rays themselves.
    [[nodiscard]] const Buffer<float>& rays() const { return rays_; }

    /// Ends the rays of packets 0 to `count` that are occluded at -1. `salt` as PixelSample's.
    void trace(std::size_t count, uint salt = 0);

    /// Bytes of a packet on the device.
    [[nodiscard]] static constexpr std::size_t packet_bytes() {
        return sizeof(float4) + 64 * sizeof(float);
    }

  private:
    Arguments scene_;
    Kernel trace_;
    std::size_t rays_per_item_;
    Buffer<float4> origins_;
    Buffer<float> rays_;
};

}  // namespace manylight

// SPDX-License-Identifier: MIT
#pragma once

#include "stages/device_scene.hpp"

namespace manylight {

/// Stage shadows: which of many rays something is in the way of. Other stages fill its buffers,
/// packets of 16 rays with one origin (layout: kernels/lib/rays.h), and read the result there.
class ShadowStage {
  public:
    /// Holds up to `packets` packets; `regions`: in regions of which only the first are in use.
    ShadowStage(Device& device, const DeviceScene& scene, std::size_t packets,
                bool regions = false);

    /// The buffers, as kernels' arguments origins and rays.
    [[nodiscard]] Arguments buffers() const;

    /// The rays themselves.
    [[nodiscard]] const Buffer<float>& rays() const { return rays_; }

    /// Ends the rays of packets 0 to `count` that are occluded at -1. `salt` as PixelSample's.
    void trace(std::size_t count, uint salt = 0) { launch(count, salt, {}); }

    /// The same of regions of `region` packets, of which packet_counts[i] are in use.
    void trace(std::size_t count, uint region, const Buffer<uint>& packet_counts, uint salt) {
        launch(count, salt, Arguments().set("region", region).set("packet_counts", packet_counts));
    }

    /// Bytes of a packet on the device.
    [[nodiscard]] static constexpr std::size_t packet_bytes() {
        return sizeof(float4) + 64 * sizeof(float);
    }

  private:
    void launch(std::size_t count, uint salt, const Arguments& regions);

    Arguments scene_;
    Kernel trace_;
    std::size_t rays_per_item_;
    Buffer<float4> origins_;
    Buffer<float> rays_;
};

}  // namespace manylight

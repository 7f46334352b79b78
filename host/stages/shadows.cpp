// SPDX-License-Identifier: MIT
#include "stages/shadows.hpp"

namespace manylight {

ShadowStage::ShadowStage(Device& device, const DeviceScene& scene, std::size_t packets)
    : scene_(scene.arguments),
      trace_(device.kernel("shadows.cl",
                           scene.packets ? "shadows_trace_packets" : "shadows_trace_rays",
                           scene.traversal, "shadows")),
      rays_per_item_(scene.packets ? 16 : 1),
      origins_(device.allocate<float4>(packets)),
      rays_(device.allocate<float>(64 * packets)) {}

Arguments ShadowStage::buffers() const {
    return Arguments().set("origins", origins_).set("rays", rays_);
}

void ShadowStage::trace(std::size_t count, uint salt) {
    trace_.launch(16 * count / rays_per_item_, Arguments(scene_)
                                                   .set(buffers())
                                                   .set("alpha_salt", salt)
                                                   .set("packet_count", static_cast<uint>(count)));
}

}  // namespace manylight

// SPDX-License-Identifier: MIT
#include "stages/shadows.hpp"

namespace manylight {
namespace {

Defines with_regions(Defines defines, bool regions) {
    defines["HAS_REGIONS"] = regions;
    return defines;
}

}  // namespace

ShadowStage::ShadowStage(Device& device, const DeviceScene& scene, std::size_t packets,
                         bool regions)
    : scene_(scene.arguments),
      trace_(device.kernel("shadows.cl",
                           scene.packets ? "shadows_trace_packets" : "shadows_trace_rays",
                           with_regions(scene.traversal, regions), "shadows")),
      rays_per_item_(scene.packets ? 16 : 1),
      origins_(device.allocate<float4>(packets)),
      rays_(device.allocate<float>(64 * packets)) {
    trace_.expect(16 * packets / rays_per_item_);
}

Arguments ShadowStage::buffers() const {
    return Arguments().set("origins", origins_).set("rays", rays_);
}

void ShadowStage::launch(std::size_t count, uint salt, const Arguments& regions) {
    trace_.launch(16 * count / rays_per_item_, Arguments(scene_)
                                                   .set(buffers())
                                                   .set(regions)
                                                   .set("alpha_salt", salt)
                                                   .set("packet_count", static_cast<uint>(count)));
}

}  // namespace manylight

// SPDX-License-Identifier: MIT
#include "stages/gbuffer.hpp"

namespace manylight {

GBufferStage::GBufferStage(Device& device, const DeviceScene& scene)
    : scene_(scene.arguments),
      trace_(device.kernel("gbuffer.cl",
                           scene.primary_packets ? "gbuffer_trace_packets" : "gbuffer_trace_rays",
                           scene.surfaces, "gbuffer")),
      rays_per_item_(scene.primary_packets ? 16 : 1) {}

void GBufferStage::trace(const Tiles& tiles, const PixelSample& sample, Buffer<Surface>& surfaces) {
    trace_.launch(item_count(tiles) / rays_per_item_, Arguments(scene_)
                                                          .set("tiles", tiles)
                                                          .set("jitter", uint{sample.jitter})
                                                          .set("pixel_sample", sample.index)
                                                          .set("seed", sample.seed)
                                                          .set("surfaces", surfaces));
}

}  // namespace manylight

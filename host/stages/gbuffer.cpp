// SPDX-License-Identifier: MIT
#include "stages/gbuffer.hpp"

#include <stdexcept>

namespace manylight {

GBufferStage::GBufferStage(Device& device, const DeviceScene& scene)
    : scene_(scene.arguments),
      materials_(scene.materials),
      own_materials_(scene.own_materials),
      varies_materials_(scene.varies_materials),
      trace_(device.kernel("gbuffer.cl",
                           scene.primary_packets ? "gbuffer_trace_packets" : "gbuffer_trace_rays",
                           scene.surfaces, "gbuffer")),
      rays_per_item_(scene.primary_packets ? 16 : 1) {}

void GBufferStage::trace(const Tiles& tiles, const PixelSample& sample, Buffer<Surface>& surfaces,
                         std::size_t first_point) {
    const std::size_t first = own_materials_ + first_point;
    if (varies_materials_ && first + item_count(tiles) > materials_.size())
        throw std::logic_error("GBufferStage: more points than upload_scene() was told");
    trace_.launch(item_count(tiles) / rays_per_item_,
                  Arguments(scene_)
                      .set("tiles", tiles)
                      .set("jitter", uint{sample.jitter})
                      .set("pixel_sample", sample.index)
                      .set("seed", sample.seed)
                      .set("alpha_salt", sample.salt())
                      .set("own_materials", static_cast<uint>(first))
                      .set("surfaces", surfaces));
}

}  // namespace manylight

// SPDX-License-Identifier: MIT
#include "stages/reflections.hpp"

namespace manylight {

ReflectionStage::ReflectionStage(Device& device, const DeviceScene& scene)
    : scene_(scene.arguments),
      add_(device.kernel("reflections.cl", "reflections_add", scene.shading, "reflections")) {}

void ReflectionStage::add(const Tiles& tiles, const PixelSample& sample,
                          const Buffer<Surface>& surfaces, Buffer<float4>& estimates) {
    add_.launch(item_count(tiles), Arguments(scene_)
                                       .set("tiles", tiles)
                                       .set("surfaces", surfaces)
                                       .set("pixel_sample", sample.index)
                                       .set("seed", sample.seed)
                                       .set("estimates", estimates));
}

}  // namespace manylight

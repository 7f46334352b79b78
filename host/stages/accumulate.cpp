// SPDX-License-Identifier: MIT
#include "stages/accumulate.hpp"

namespace manylight {

AccumulateStage::AccumulateStage(Device& device, const DeviceScene& scene)
    : scene_(scene.arguments),
      add_(device.kernel("accumulate.cl", "accumulate_add", scene.emission, "accumulate")) {}

void AccumulateStage::add(const Tiles& tiles, const Buffer<Surface>& surfaces,
                          const Buffer<float4>& estimates, ImageSum& image) {
    add_.launch(item_count(tiles), Arguments(scene_)
                                       .set("tiles", tiles)
                                       .set("surfaces", surfaces)
                                       .set("estimates", estimates)
                                       .set("image", image.sums)
                                       .set("residuals", image.residuals));
}

}  // namespace manylight

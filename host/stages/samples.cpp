// SPDX-License-Identifier: MIT
#include "stages/samples.hpp"

namespace manylight {

SampleStage::SampleStage(Device& device, const DeviceScene& scene, std::string_view file,
                         std::size_t items)
    : scene_(scene.arguments),
      shadows_(device, scene, items),
      draw_(device.kernel(file, "samples_draw", scene.shading, "samples")),
      add_(device.kernel("samples.cl", "samples_add", scene.traversal, "samples")),
      values_(device.allocate<float>(48 * items)) {}

bool SampleStage::draw(const Tiles& tiles, const PixelSample& sample, uint light_samples,
                       const Buffer<Surface>& surfaces, const Arguments& tables,
                       Estimates& estimates, const std::function<bool(std::size_t)>& progress) {
    const std::size_t items = item_count(tiles);
    Arguments arguments = scene_;
    arguments.set(tables)
        .set(shadows_.buffers())
        .set("tiles", tiles)
        .set("surfaces", surfaces)
        .set("pixel_sample", sample.index)
        .set("seed", sample.seed)
        .set("sample_count", light_samples)
        .set("values", values_)
        .set("estimates", estimates.sums)
        .set("residuals", estimates.residuals);
    for (uint first = 0; first < light_samples; first += 16) {
        const uint end = std::min(first + 16, light_samples);
        arguments.set("first_sample", first).set("end_sample", end).set("start", uint{first == 0});
        draw_.launch(items, arguments);
        shadows_.trace(items, sample.salt());
        add_.launch(items, arguments);
        const bool goes_on = progress(items * (end - first));
        if (!goes_on && end < light_samples) return false;
    }
    return true;
}

}  // namespace manylight

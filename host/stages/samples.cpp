// SPDX-License-Identifier: MIT
#include "stages/samples.hpp"

namespace manylight {

SampleStage::SampleStage(Device& device, const DeviceScene& scene, std::string_view file,
                         std::size_t per_launch)
    : scene_(scene.arguments),
      draw_(device.kernel(file, "samples_draw", scene.shading, "samples")),
      per_launch_(per_launch) {}

void SampleStage::draw(const Tiles& tiles, const PixelSample& sample, uint light_samples,
                       const Buffer<Surface>& surfaces, const Arguments& tables,
                       Estimates& estimates, const std::function<void(std::size_t)>& progress) {
    Arguments arguments = scene_;
    arguments.set(tables)
        .set("tiles", tiles)
        .set("surfaces", surfaces)
        .set("pixel_sample", sample.index)
        .set("seed", sample.seed)
        .set("sample_count", light_samples)
        .set("estimates", estimates.sums)
        .set("residuals", estimates.residuals);
    const auto step = static_cast<uint>(std::max<std::size_t>(per_launch_ / item_count(tiles), 1));
    for (uint first = 0; first < light_samples; first += step) {
        const uint end = std::min(first + step, light_samples);
        draw_.launch(item_count(tiles),
                     arguments.set("first_sample", first).set("end_sample", end));
        progress(item_count(tiles) * (end - first));
    }
}

}  // namespace manylight

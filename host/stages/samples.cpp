// SPDX-License-Identifier: MIT
#include "stages/samples.hpp"

namespace manylight {
namespace {

constexpr std::size_t samples_per_launch = std::size_t{1} << 22;  // about a second of shadow rays

}  // namespace

SampleStage::SampleStage(Device& device, const DeviceScene& scene, std::string_view file)
    : scene_(scene.arguments),
      draw_(device.kernel(file, "samples_draw", scene.shading, "samples")) {}

void SampleStage::draw(const Tiles& tiles, const PixelSample& sample, uint light_samples,
                       const Buffer<Surface>& surfaces, const Arguments& tables,
                       Buffer<float4>& estimates,
                       const std::function<void(std::size_t)>& progress) {
    Arguments arguments = scene_;
    arguments.set(tables)
        .set("tiles", tiles)
        .set("surfaces", surfaces)
        .set("pixel_sample", sample.index)
        .set("seed", sample.seed)
        .set("sample_count", light_samples)
        .set("estimates", estimates);
    const auto step =
        static_cast<uint>(std::max<std::size_t>(samples_per_launch / item_count(tiles), 1));
    for (uint first = 0; first < light_samples; first += step) {
        const uint end = std::min(first + step, light_samples);
        draw_.launch(item_count(tiles),
                     arguments.set("first_sample", first).set("end_sample", end));
        progress(item_count(tiles) * (end - first));
    }
}

}  // namespace manylight

// SPDX-License-Identifier: MIT
#include "stages/adaptive.hpp"

namespace manylight {

AdaptiveStage::AdaptiveStage(Device& device, const DeviceScene& scene, std::size_t packets,
                             std::size_t pixels)
    : scene_(scene.arguments),
      reflections_(scene.shading.at("HAS_REFLECTIONS") != 0),
      shadows_(device, scene, packets),
      drawn_(device.allocate<uint>(16 * packets)),
      shares_(device.allocate<float>(16 * packets)),
      base_(device.allocate<float4>(packets)),
      values_(device.allocate<float>(48 * packets)),
      expectations_(device.allocate<Expectation>(pixels)) {
    const auto kernel = [&](const char* name, const char* stage) {
        return device.kernel("samplers/adaptive.cl", name, scene.shading, stage);
    };
    draw_ = kernel("adaptive_draw", "weights");
    aim_ = kernel("adaptive_aim", "samples");
    add_ = kernel("adaptive_add", "samples");
}

Arguments AdaptiveStage::draws() const {
    return shadows_.buffers()
        .set("drawn", drawn_)
        .set("shares", shares_)
        .set("base", base_)
        .set("values", values_);
}

void AdaptiveStage::draw(const Tiles& tiles, const Pass& pass, const Budget& budget,
                         const PixelSample& sample, const Buffer<Surface>& surfaces,
                         const Cuts& cuts, const Visibility& visibility, float weight, bool start,
                         Estimates& estimates) {
    Arguments arguments = scene_;
    arguments.set(cuts.arguments())
        .set(visibility.arguments())
        .set(draws())
        .set("expectations", expectations_)
        .set("tiles", tiles)
        .set("pass", pass)
        .set("budget", budget)
        .set("surfaces", surfaces)
        .set("pixel_sample", sample.index)
        .set("seed", sample.seed)
        .set("weight", weight)
        .set("start", uint{start})
        .set("estimates", estimates.sums);
    draw_.launch(pass_pixels(pass) / 16, arguments);
    if (cuts.groups || reflections_) aim_.launch(pass_pixels(pass), arguments);
    shadows_.trace(pass_pixels(pass) * pass.packets, sample.salt());
    add_.launch(pass_pixels(pass), arguments);
}

}  // namespace manylight

// SPDX-License-Identifier: MIT
#include "samplers/one_light/one_light.hpp"

namespace manylight {

OneLight::OneLight(const SamplerContext& context, std::string_view file)
    : stage_(context.device, context.scene, file, context.items()) {}

bool OneLight::draw(const Tiles& tiles, const PixelSample& sample, uint light_samples,
                    const Buffer<Surface>& surfaces, Estimates& estimates, const Sink& sink) {
    return stage_.draw(tiles, sample, light_samples, surfaces, tables_, estimates,
                       [&](std::size_t samples) { return sink({}, samples); });
}

Footprint OneLight::footprint(const SamplerLoad& load) {
    Footprint out;
    out.tile = load.tile_items() * SampleStage::item_bytes();
    out.tile_buffer = load.tile_items() * 64 * sizeof(float);  // rays
    return out;
}

}  // namespace manylight

// SPDX-License-Identifier: MIT
#include "samplers/one_light/one_light.hpp"

namespace manylight {

Sampler sampler_exhaustive() {
    return {.name = "exhaustive",
            .summary = "all lights at every pixel sample: exact, slow",
            .color = "#444444",
            .all_lights = true,
            .footprint = OneLight::footprint,
            .make = [](const SamplerContext& context) -> std::unique_ptr<LightSampler> {
                return std::make_unique<OneLight>(context, "samplers/exhaustive/exhaustive.cl");
            }};
}

}  // namespace manylight

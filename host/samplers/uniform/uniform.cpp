// SPDX-License-Identifier: MIT
#include "samplers/one_light/one_light.hpp"

namespace manylight {

Sampler sampler_uniform() {
    return {.name = "uniform",
            .summary = "every light alike",
            .color = "#8c564b",
            .closed_form = "samplers/uniform/uniform.cl",
            .footprint = OneLight::footprint,
            .make = [](const SamplerContext& context) -> std::unique_ptr<LightSampler> {
                return std::make_unique<OneLight>(context, "samplers/uniform/uniform.cl");
            }};
}

}  // namespace manylight

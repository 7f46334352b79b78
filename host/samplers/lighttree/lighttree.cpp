// SPDX-License-Identifier: MIT
#include "samplers/one_light/one_light.hpp"

namespace manylight {

Sampler sampler_lighttree() {
    return {.name = "lighttree",
            .summary = "down a light tree by bounds on distance, angles and power (pbrt-v4's)",
            .color = "#1f77b4",
            .tree = true,
            .closed_form = "samplers/lighttree/lighttree.cl",
            .footprint = OneLight::footprint,
            .make = [](const SamplerContext& context) -> std::unique_ptr<LightSampler> {
                return std::make_unique<OneLight>(context, "samplers/lighttree/lighttree.cl");
            }};
}

}  // namespace manylight

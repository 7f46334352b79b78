// SPDX-License-Identifier: MIT
#include "samplers/power/power.hpp"

namespace manylight {

Sampler sampler_ris() {
    return {.name = "ris",
            .summary = "one of 32 candidates by power, by its contribution without shadows",
            .color = "#2ca02c",
            .footprint = ByPower::footprint,
            .make = [](const SamplerContext& context) -> std::unique_ptr<LightSampler> {
                return std::make_unique<ByPower>(context, "samplers/ris/ris.cl");
            }};
}

}  // namespace manylight

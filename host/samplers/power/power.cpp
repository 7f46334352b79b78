// SPDX-License-Identifier: MIT
#include "samplers/power/power.hpp"

namespace manylight {

ByPower::ByPower(const SamplerContext& context, std::string_view file)
    : OneLight(context, file),
      pdf_stage_(context.device, context.scene),
      mixture_(mixture_of({.power = 1}, context.lights)) {}

void ByPower::prepare() { tables_.set("power_cdf", pdf_stage_.of_powers(mixture_)); }

Footprint ByPower::footprint(const SamplerLoad& load) {
    Footprint out = OneLight::footprint(load);
    out.image = Matrix::row_bytes(load.lights);
    return out;
}

Sampler sampler_power() {
    return {.name = "power",
            .summary = "lights by their power",
            .color = "#9467bd",
            .closed_form = "samplers/power/power.cl",
            .footprint = ByPower::footprint,
            .make = [](const SamplerContext& context) -> std::unique_ptr<LightSampler> {
                return std::make_unique<ByPower>(context, "samplers/power/power.cl");
            }};
}

}  // namespace manylight

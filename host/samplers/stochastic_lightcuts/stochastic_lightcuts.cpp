// SPDX-License-Identifier: MIT
#include "samplers/stochastic_lightcuts/stochastic_lightcuts.hpp"

#include "shared/stochastic_lightcuts.h"

namespace manylight {

StochasticLightcuts::StochasticLightcuts(const SamplerContext& context)
    : OneLight(context, "samplers/stochastic_lightcuts/stochastic_lightcuts.cl"),
      cut_nodes_(static_cast<uint>(context.parameter("cut"))) {
    tables_.set("cut_nodes", cut_nodes_);
}

Sampler sampler_stochastic_lightcuts() {
    return {
        .name = "stochastic-lightcuts",
        .summary = "a light of each node of a cut of the light tree, chosen by bounds (Yuksel)",
        .color = "#17becf",
        .tree = true,
        .parameters = {{"cut", MOST_CUT_NODES, 1, MOST_CUT_NODES, "nodes of a cut, at most", true}},
        .closed_form = "samplers/stochastic_lightcuts/stochastic_lightcuts.cl",
        .footprint = OneLight::footprint,
        .make = [](const SamplerContext& context) -> std::unique_ptr<LightSampler> {
            return std::make_unique<StochasticLightcuts>(context);
        }};
}

}  // namespace manylight

// SPDX-License-Identifier: MIT
#include "reference/samplers/stochastic_lightcuts.hpp"
#include "samplers/stochastic_lightcuts/stochastic_lightcuts.hpp"
#include "verify/sampler_checks.hpp"

namespace manylight {

SamplerChecks checks_stochastic_lightcuts() {
    return {.reference = [](const LightSampler& sampler,
                            const CheckContext& context) -> std::unique_ptr<reference::Sampler> {
                return std::make_unique<reference::StochasticLightcuts>(
                    context.tree, dynamic_cast<const StochasticLightcuts&>(sampler).cut_nodes());
            },
            .run = check_samples};
}

}  // namespace manylight

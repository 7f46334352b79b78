// SPDX-License-Identifier: MIT
#include "verify/sampler_checks.hpp"

namespace manylight {

SamplerChecks checks_power() {
    return {.choose_light = reference::choose_power,
            .light_probability = reference::probability_power,
            .run = [](Verifier& verifier, const Sampler& sampler) -> std::vector<Check> {
                return {verifier.pdf("power", {.power = 1}, false), verifier.samples(sampler)};
            }};
}

}  // namespace manylight

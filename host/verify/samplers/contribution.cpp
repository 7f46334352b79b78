// SPDX-License-Identifier: MIT
#include "samplers/contribution/contribution.hpp"
#include "verify/sampler_checks.hpp"

namespace manylight {

SamplerChecks checks_contribution() {
    return {.choose_light = reference::choose_contribution,
            .light_probability = reference::probability_contribution,
            .run = [](Verifier& verifier, const Sampler& sampler) -> std::vector<Check> {
                return {verifier.pdf(sampler.name, paper_shares, true), verifier.samples(sampler)};
            }};
}

SamplerChecks checks_contribution_defensive() {
    return {
        .choose_light = reference::choose_contribution,
        .light_probability = reference::probability_contribution,
        .run = [](Verifier& verifier, const Sampler& sampler) -> std::vector<Check> {
            return {verifier.pdf(sampler.name, defensive_shares, true), verifier.samples(sampler)};
        }};
}

}  // namespace manylight

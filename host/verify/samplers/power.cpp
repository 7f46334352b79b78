// SPDX-License-Identifier: MIT
#include "reference/samplers/power.hpp"
#include "verify/sampler_checks.hpp"

namespace manylight {

SamplerChecks checks_power() {
    return {
        .reference = [](const LightSampler& sampler,
                        const CheckContext& /*context*/) -> std::unique_ptr<reference::Sampler> {
            return std::make_unique<reference::ByPower>(
                tables_of(sampler).download<uint>("power_cdf"));
        },
        .stages = {"pdf", "samples"},
        .run = [](Verifier& verifier, const Sampler& sampler) -> std::vector<Check> {
            return {check_pdf(verifier, "power", {.power = 1}, false),
                    check_estimates(verifier, sampler)};
        }};
}

}  // namespace manylight

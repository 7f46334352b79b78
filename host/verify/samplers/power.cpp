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
        .run = [](Verifier& verifier, const Sampler& sampler) -> std::vector<Check> {
            return {verifier.pdf("power", {.power = 1}, false), verifier.samples(sampler)};
        }};
}

}  // namespace manylight

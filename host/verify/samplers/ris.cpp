// SPDX-License-Identifier: MIT
#include "reference/samplers/ris.hpp"
#include "verify/sampler_checks.hpp"

namespace manylight {

// The probability of a light depends on all candidates: no closed form. Its estimates are judged
// draw by draw instead.
SamplerChecks checks_ris() {
    return {
        .reference = [](const LightSampler& sampler,
                        const CheckContext& /*context*/) -> std::unique_ptr<reference::Sampler> {
            return std::make_unique<reference::ByCandidates>(
                tables_of(sampler).download<uint>("power_cdf"));
        },
        .run = check_samples};
}

}  // namespace manylight

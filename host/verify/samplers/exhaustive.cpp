// SPDX-License-Identifier: MIT
#include "reference/samplers/exhaustive.hpp"
#include "verify/sampler_checks.hpp"

namespace manylight {

SamplerChecks checks_exhaustive() {
    return {
        .reference = [](const LightSampler& /*sampler*/,
                        const CheckContext& /*context*/) -> std::unique_ptr<reference::Sampler> {
            return std::make_unique<reference::Exhaustive>();
        },
        .run = check_samples};
}

}  // namespace manylight

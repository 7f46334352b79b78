// SPDX-License-Identifier: MIT
#include "reference/samplers/uniform.hpp"
#include "verify/sampler_checks.hpp"

namespace manylight {

SamplerChecks checks_uniform() {
    return {
        .reference = [](const LightSampler& /*sampler*/,
                        const CheckContext& /*context*/) -> std::unique_ptr<reference::Sampler> {
            return std::make_unique<reference::Uniform>();
        },
        .run = check_samples};
}

}  // namespace manylight

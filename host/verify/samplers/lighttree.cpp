// SPDX-License-Identifier: MIT
#include "reference/samplers/lighttree.hpp"
#include "verify/sampler_checks.hpp"

namespace manylight {

SamplerChecks checks_lighttree() {
    return {.reference = [](const LightSampler& /*sampler*/,
                            const CheckContext& context) -> std::unique_ptr<reference::Sampler> {
                return std::make_unique<reference::DownLightTree>(context.tree);
            },
            .run = check_samples};
}

}  // namespace manylight

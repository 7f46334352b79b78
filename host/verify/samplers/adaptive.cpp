// SPDX-License-Identifier: MIT
#include <algorithm>

#include "shared/adaptive.h"
#include "verify/sampler_checks.hpp"

namespace manylight {

SamplerChecks checks_adaptive() {
    return {.run = [](Verifier& verifier, const Sampler&) {
        // Half as many nodes as lights, so that some are groups.
        const std::size_t half = (verifier.lights().size() + 1) / 2;
        return verifier.adaptive(static_cast<uint>(std::clamp<std::size_t>(half, 2, CUT_CAPACITY)));
    }};
}

}  // namespace manylight

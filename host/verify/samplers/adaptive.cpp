// SPDX-License-Identifier: MIT
#include <algorithm>

#include "shared/adaptive.h"
#include "verify/sampler_checks.hpp"

namespace manylight {

SamplerChecks checks_adaptive() {
    return {.run = [](Verifier& verifier, const Sampler&) {
        // Half as many nodes as lights, so that some are groups.
        const std::size_t half = (verifier.lights().size() + 1) / 2;
        std::vector<Check> checks =
            verifier.adaptive(static_cast<uint>(std::clamp<std::size_t>(half, 2, CUT_CAPACITY)));
        if (!verifier.lights().empty()) checks.insert(checks.begin(), verifier.seen_lights());
        return checks;
    }};
}

}  // namespace manylight

// SPDX-License-Identifier: MIT
#include "verify/sampler_checks.hpp"

namespace manylight {

SamplerChecks checks_exhaustive() {
    return {.choose_light = reference::choose_exhaustive, .run = check_samples};
}

}  // namespace manylight

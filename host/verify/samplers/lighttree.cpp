// SPDX-License-Identifier: MIT
#include "verify/sampler_checks.hpp"

namespace manylight {

SamplerChecks checks_lighttree() {
    return {.choose_light = reference::choose_lighttree,
            .light_probability = reference::probability_lighttree,
            .run = check_samples};
}

}  // namespace manylight

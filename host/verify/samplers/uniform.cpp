// SPDX-License-Identifier: MIT
#include "verify/sampler_checks.hpp"

namespace manylight {

SamplerChecks checks_uniform() {
    return {.choose_light = reference::choose_uniform,
            .light_probability = reference::probability_uniform,
            .run = check_samples};
}

}  // namespace manylight

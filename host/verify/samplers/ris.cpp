// SPDX-License-Identifier: MIT
#include "verify/sampler_checks.hpp"

namespace manylight {

// The probability of a light depends on all candidates: no closed form. Its estimates are judged
// draw by draw instead.
SamplerChecks checks_ris() { return {.choose_light = reference::choose_ris, .run = check_samples}; }

}  // namespace manylight

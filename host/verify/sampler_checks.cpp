// SPDX-License-Identifier: MIT
#include "verify/sampler_checks.hpp"

#include <algorithm>

#include "samplers/rows.hpp"

namespace manylight {

#define DECLARE_ROW(name) SamplerChecks checks_##name();
MANYLIGHT_SAMPLERS(DECLARE_ROW)
#undef DECLARE_ROW

const SamplerChecks& checks_of(const Sampler& sampler) {
#define MAKE_ROW(name) checks_##name(),
    static const SamplerChecks checks[] = {MANYLIGHT_SAMPLERS(MAKE_ROW)};
#undef MAKE_ROW
    const std::span<const Sampler> all = all_samplers();
    return checks[std::ranges::find(all, sampler.name, &Sampler::name) - all.begin()];
}

const Arguments& tables_of(const LightSampler& sampler) {
    return dynamic_cast<const OneLight&>(sampler).tables();
}

std::vector<Check> check_samples(Verifier& verifier, const Sampler& sampler) {
    return {verifier.samples(sampler)};
}

}  // namespace manylight

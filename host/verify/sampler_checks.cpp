// SPDX-License-Identifier: MIT
#include "verify/sampler_checks.hpp"

#include <algorithm>

#include "samplers/one_light/one_light.hpp"
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

HostTables::HostTables(const LightSampler& sampler) {
    const Arguments& tables = dynamic_cast<const OneLight&>(sampler).tables();
    power_cdf = tables.download<uint>("power_cdf");
    cdf = tables.download<uint>("cdf");
    item_rows = tables.download<uint>("item_rows");
}

std::vector<Check> check_samples(Verifier& verifier, const Sampler& sampler) {
    return {verifier.samples(sampler)};
}

}  // namespace manylight

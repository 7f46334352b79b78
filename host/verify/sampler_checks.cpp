// SPDX-License-Identifier: MIT
#include "verify/sampler_checks.hpp"

#include <algorithm>

#include "samplers/rows.hpp"
#include "verify/stages.hpp"

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
    return {check_estimates(verifier, sampler)};
}

// The row of stages: all of all samplers, or of those that are selected.
StageCheck check_samplers() {
    StageCheck row{.receivers = true, .of_samplers = true, .run = [](Verifier& verifier) {
                       std::vector<Check> checks;
                       const Selection& only = verifier.options().only;
                       for (const Sampler& sampler : all_samplers()) {
                           const SamplerChecks& own = checks_of(sampler);
                           if (!only.takes_sampler(sampler.name) || !only.takes_one_of(own.stages))
                               continue;
                           for (Check& check : own.run(verifier, sampler)) {
                               check.sampler = sampler.name;
                               checks.push_back(std::move(check));
                           }
                       }
                       return checks;
                   }};
    for (const Sampler& sampler : all_samplers())
        for (const std::string_view stage : checks_of(sampler).stages)
            if (std::ranges::find(row.stages, stage) == row.stages.end())
                row.stages.push_back(stage);
    return row;
}

}  // namespace manylight

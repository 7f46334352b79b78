// SPDX-License-Identifier: MIT
#include "samplers/table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "error.hpp"
#include "samplers/rows.hpp"
#include "shared/adaptive.h"

namespace manylight {

#define DECLARE_ROW(name) Sampler sampler_##name();
MANYLIGHT_SAMPLERS(DECLARE_ROW)
#undef DECLARE_ROW

std::span<const Sampler> all_samplers() {
#define MAKE_ROW(name) sampler_##name(),
    static const Sampler samplers[] = {MANYLIGHT_SAMPLERS(MAKE_ROW)};
#undef MAKE_ROW
    return samplers;
}

SamplerChoice choose_sampler(std::size_t lights, uint light_samples, bool clusters_wanted) {
    if (clusters_wanted) return {"contribution-defensive", "clusters are asked for"};
    if (lights == 0) return {"exhaustive", "there is no light"};
    if (lights <= light_samples)
        return {"exhaustive", fmt::format("{} light{}, no more than light samples", lights,
                                          lights == 1 ? "" : "s")};
    if (lights <= CUT_CAPACITY)
        return {"adaptive", fmt::format("{} lights, few enough to look at each", lights)};
    return {"adaptive", fmt::format("{} lights, by cuts of the light tree", lights)};
}

const Sampler& find_sampler(std::string_view name, std::string_view option) {
    std::string names;
    for (const Sampler& sampler : all_samplers()) {
        if (sampler.name == name) return sampler;
        names += fmt::format("{}{}", names.empty() ? "" : ", ", sampler.name);
    }
    throw InputError("{} {}: no such sampler (there are: {})", option, name, names);
}

ParameterValues values_of(const Sampler& sampler, const ParameterValues& set) {
    ParameterValues values;
    for (const Parameter& p : sampler.parameters) values.emplace(p.name, p.value);
    for (const auto& [name, value] : set) {
        const auto found = std::ranges::find(sampler.parameters, name, &Parameter::name);
        if (found == sampler.parameters.end()) {
            std::string names;
            for (const Parameter& p : sampler.parameters)
                names += fmt::format("{}{}", names.empty() ? "" : ", ", p.name);
            throw InputError("--set {}={}: sampler {} has no such parameter ({})", name, value,
                             sampler.name, names.empty() ? "it has none" : "it has: " + names);
        }
        if (!(value >= found->least && value <= found->most))
            throw InputError("--set {}={}: it is from {} to {}", name, value, found->least,
                             found->most);
        if (found->whole && value != std::floor(value))
            throw InputError("--set {}={}: it is a whole number", name, value);
        values[name] = value;
    }
    return values;
}

std::string text_of(const ParameterValues& values) {
    std::string text;
    for (const auto& [name, value] : values)
        text += fmt::format("{}{}={}", text.empty() ? "" : ",", name, value);
    return text;
}

}  // namespace manylight

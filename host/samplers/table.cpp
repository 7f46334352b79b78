// SPDX-License-Identifier: MIT
#include "samplers/table.hpp"

#include "error.hpp"
#include "shared/adaptive.h"

namespace manylight {
namespace {

constexpr Sampler samplers[] = {
    {.name = "exhaustive",
     .summary = "all lights at every pixel sample: exact, slow",
     .all_lights = true,
     .kernel_file = "samplers/exhaustive.cl",
     .choose_light = reference::choose_exhaustive},
    {.name = "uniform",
     .summary = "every light alike",
     .kernel_file = "samplers/uniform.cl",
     .choose_light = reference::choose_uniform},
    {.name = "power",
     .summary = "lights by their power",
     .table = Table::power,
     .shares = {.power = 1},
     .kernel_file = "samplers/power.cl",
     .choose_light = reference::choose_power},
    {.name = "ris",
     .summary = "one of 32 candidates by power, by its contribution without shadows",
     .table = Table::power,
     .shares = {.power = 1},
     .kernel_file = "samplers/ris.cl",
     .choose_light = reference::choose_ris},
    {.name = "lighttree",
     .summary = "down a light tree by bounds on distance, angles and power (pbrt-v4's)",
     .table = Table::tree,
     .kernel_file = "samplers/lighttree.cl",
     .choose_light = reference::choose_lighttree},
    {.name = "adaptive",
     .summary = "by contribution and learned visibility, from a cut of the light tree per tile",
     .table = Table::cuts,
     .kernel_file = "samplers/adaptive.cl"},
    {.name = "contribution",
     .summary = "by contribution to the cluster's representative, shadows included (the paper's)",
     .biased = true,
     .table = Table::clusters,
     .shares = {.visible = 1},
     .kernel_file = "samplers/contribution.cl",
     .choose_light = reference::choose_contribution},
    {.name = "contribution-defensive",
     .summary = "the paper's, mixed with unshadowed contribution and power",
     .table = Table::clusters,
     .weighs_shadow = true,
     .shares = {.visible = 0.4f, .unshadowed = 0.5f, .power = 0.1f},
     .kernel_file = "samplers/contribution.cl",
     .choose_light = reference::choose_contribution},
};

}  // namespace

std::span<const Sampler> all_samplers() { return samplers; }

Mixture mixture_of(const Sampler& sampler, const std::vector<Light>& lights) {
    double power = 0;
    for (const Light& light : lights) power += light.emission.w;
    return {sampler.shares.visible, sampler.shares.unshadowed, sampler.shares.power,
            static_cast<float>(power)};
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
    for (const Sampler& sampler : samplers) {
        if (sampler.name == name) return sampler;
        names += fmt::format("{}{}", names.empty() ? "" : ", ", sampler.name);
    }
    throw InputError("{} {}: no such sampler (there are: {})", option, name, names);
}

}  // namespace manylight

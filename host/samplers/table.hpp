// SPDX-License-Identifier: MIT
// The one table of samplers. Command line, help, verify, tests and documents follow it.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "reference/samples.hpp"
#include "shared/contribution.h"

namespace manylight {

/// What a sampler draws from.
enum class Table {
    none,
    power,     // one CDF by the lights' power, for the whole image
    tree,      // the light trees
    cuts,      // a cut of the light trees per tile, and what was learned of its visibility
    clusters,  // a CDF per cluster of pixels, from the contribution matrix
};

/// How the rows of a sampler's CDFs are mixed; see Mixture in shared/contribution.h.
struct Shares {
    float visible = 0;
    float unshadowed = 0;
    float power = 0;
};

struct Sampler {
    std::string_view name;
    std::string_view summary;  // one line for help
    bool biased = false;
    bool all_lights = false;  // light sample i is light i
    Table table = Table::none;
    bool weighs_shadow = false;  // clusters: see ShadowRule
    Shares shares = {};
    std::string_view kernel_file;  // below kernels/
    reference::ChooseLight choose_light = nullptr;

    [[nodiscard]] bool uses_tree() const { return table == Table::tree || table == Table::cuts; }
};

[[nodiscard]] std::span<const Sampler> all_samplers();

/// How a sampler mixes its rows, for a scene's lights.
[[nodiscard]] Mixture mixture_of(const Sampler& sampler, const std::vector<Light>& lights);

/// What --sampler auto, the default, is for a scene.
struct SamplerChoice {
    std::string_view name;
    std::string reason;
};

/// The sampler that does no more than the scene needs.
[[nodiscard]] SamplerChoice choose_sampler(std::size_t lights, uint light_samples,
                                           bool clusters_wanted);

/// Throws InputError for a name, given by `option`, that is not in the table.
[[nodiscard]] const Sampler& find_sampler(std::string_view name,
                                          std::string_view option = "--sampler");

}  // namespace manylight

// SPDX-License-Identifier: MIT
// The one table of samplers. Command line, help, verify, tests and documents follow it.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "samplers/sampler.hpp"

namespace manylight {

[[nodiscard]] std::span<const Sampler> all_samplers();

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

/// The values of all parameters of a sampler: those of `set`, and the defaults. Throws InputError
/// for one that it does not have, or beyond its limits.
[[nodiscard]] ParameterValues values_of(const Sampler& sampler, const ParameterValues& set = {});

/// "tau=0.05,certainty=1".
[[nodiscard]] std::string text_of(const ParameterValues& values);

}  // namespace manylight

// SPDX-License-Identifier: MIT
#pragma once

#include <span>

#include "reference/shading.hpp"
#include "shared/tiles.h"

namespace manylight::reference {

/// What a sampler may draw from; a sampler uses what it needs.
struct Tables {
    std::span<const uint> power_cdf;  // [light]
    std::span<const uint> cdf;        // [row * light_count + light]
    std::span<const uint> item_rows;  // [item]
};

/// A light sample: which light, and 1 / (N p) of paper eq. (2); weight 0: none.
struct Choice {
    uint light;
    double weight;
};

/// Light sample `sample` of `sample_count` at an item, from 32 random bits.
using ChooseLight = Choice (*)(const Tables& tables, std::size_t item, uint sample,
                               uint sample_count, uint random, uint light_count);

[[nodiscard]] Choice choose_exhaustive(const Tables&, std::size_t, uint, uint, uint, uint);
[[nodiscard]] Choice choose_uniform(const Tables&, std::size_t, uint, uint, uint, uint);
[[nodiscard]] Choice choose_power(const Tables&, std::size_t, uint, uint, uint, uint);
[[nodiscard]] Choice choose_contribution(const Tables&, std::size_t, uint, uint, uint, uint);

/// One pixel sample's estimate and what rounding may do to it.
struct Estimate {
    glm::dvec3 value;       // cd/m2
    glm::dvec3 magnitude;   // sum of the terms' absolute values
    double slack = 0;       // of rounding, where asked for
    double borderline = 0;  // sum of the terms whose visibility rounding decides, where asked for
};

/// Stage samples for one item; `judge`: fill slack and borderline (slow).
[[nodiscard]] Estimate estimate(const Scene& scene, const Tracer& tracer, const Camera& camera,
                                const Surface& surface, const Tables& tables, ChooseLight choose,
                                std::size_t item, uint pixel, uint pixel_sample, uint seed,
                                uint sample_count, bool judge);

}  // namespace manylight::reference

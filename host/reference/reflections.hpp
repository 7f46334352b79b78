// SPDX-License-Identifier: MIT
#pragma once

#include "reference/shading.hpp"

namespace manylight::reference {

/// The numbers, in [0, 1)^2, that a pixel sample's reflected direction is drawn from.
[[nodiscard]] glm::dvec2 reflection_point(uint pixel, uint pixel_sample, uint seed);

/// Stage reflections for one pixel sample.
struct Reflection {
    glm::dvec3 value{0};      // cd/m2
    double slack = 0;         // by how much rounding may change it, where asked for
    bool borderline = false;  // rounding decides what the ray hits, where asked for
};

/// What stage reflections adds to the estimate at a surface; `judge`: fill slack and borderline
/// (slow).
[[nodiscard]] Reflection reflection(const Scene& scene, const Tracer& tracer, const Viewer& viewer,
                                    const Surface& surface, uint pixel, uint pixel_sample,
                                    uint seed, bool judge);

}  // namespace manylight::reference

// SPDX-License-Identifier: MIT
// What the host asks of lights of any kind; lights/kinds.cpp answers for each. Fields of a light:
// shared/light.h.
#pragma once

#include <array>
#include <glm/glm.hpp>

#include "shared/light.h"

namespace manylight {

[[nodiscard]] inline LightKind kind_of(const Light& light) {
    return static_cast<LightKind>(light.position.w);
}

[[nodiscard]] inline bool light_has(const Light& light, LightTrait trait) {
    return light_has(kind_of(light), trait);
}

/// As LIGHT_KINDS has it.
[[nodiscard]] const char* name_of(LightKind kind);

/// Luminous power, lm, where the emission's luminance is `luminance`; of a light that is infinitely
/// far through a disc of `radius`, m, across it.
[[nodiscard]] float power_of(const Light& light, float luminance, float radius);

/// Where a light lies, m, in the lights' frame; one that is infinitely far at the unit direction to
/// it. Number: float or double, in which all is computed but the area.
template <class Number>
struct Extent {
    using Vector = glm::vec<3, Number>;
    std::array<Vector, 4> corners;  // of an area, which they hold; or all the same
    Vector centre;
    Number area;         // m2; 1 without one
    Number mean_square;  // distance to the centre, m2
};
template <class Number>
[[nodiscard]] Extent<Number> extent_of(const Light& light);

/// The normal of an area, as long as the parallelogram of axis and edge is large, m2: single
/// precision would lose the square of a small one.
[[nodiscard]] inline glm::dvec3 area_normal(const Light& light) {
    return glm::cross(glm::dvec3(light.axis), glm::dvec3(light.edge));
}

/// Whether an area shines to both sides.
[[nodiscard]] inline bool shines_to_both_sides(const Light& light) {
    return light_has(light, TRAIT_AREA) && light.axis.w != 0;
}

/// Whether a light shines about one axis.
[[nodiscard]] inline bool has_axis(const Light& light) {
    return !light_has(light, TRAIT_EVEN) && !shines_to_both_sides(light);
}

/// That axis, unit; 0 if there is none.
[[nodiscard]] glm::vec3 axis_of(const Light& light);

}  // namespace manylight

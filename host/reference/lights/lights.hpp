// SPDX-License-Identifier: MIT
// What the reference says of lights of any kind; a file each says it of a kind. Fields of a light:
// shared/light.h.
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "shared/light.h"
#include "shared/light_tree.h"

namespace manylight::reference {

/// By how much rounding may have changed what a light's emission comes from.
struct LightShift {
    glm::dvec3 normal = glm::dvec3(0);   // of an area: of the cross product of its sides, m2
    double versine = 0;                  // of a cone: 1 - the cosine to its axis
    glm::dvec3 towards = glm::dvec3(0);  // of what is infinitely far: unit direction to it
};

/// A light, or a point of it, as a surface point sees it.
struct Emission {
    glm::dvec3 towards;  // unit, to the light
    glm::dvec3 target;   // end of the shadow ray
    glm::dvec3 light;    // illuminance at normal incidence, lx
    bool infinite = false;
    std::optional<double> plane;  // if infinite: shadow rays end at dot(-towards, p) = plane
    double solid_angle = 0;       // of a light with area, sr
    glm::dvec3 moved{0};          // by how much rounding moves the target along each axis, m
};

/// The light, or its point u in [0, 1)^2, seen from `position`.
[[nodiscard]] Emission emission(const Light& light, const glm::dvec3& position, const glm::dvec2& u,
                                const LightShift& shift = {});

/// The shifts that rounding to single precision may make of a light; each may also be the opposite.
/// Of an area's normal (a cross product) by 2 units of the product of its sides, of the direction
/// to a light that is infinitely far by 4 units, and of 1 - the cosine to a cone's axis by what 4
/// units do to the sine.
[[nodiscard]] std::vector<LightShift> light_shifts(const Light& light, const glm::dvec3& position);

/// A leaf of the light tree whose centre is off a point by `to_centre`, m: its emission relative to
/// a point's that shines evenly, times distance squared over the same with the leaf's mean square
/// (`softened`, m2). None where a leaf is estimated as a group is.
[[nodiscard]] std::optional<double> leaf_emission(const LightNode& node, const Light& light,
                                                  const glm::dvec3& to_centre, double softened);

}  // namespace manylight::reference

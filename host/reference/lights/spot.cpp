// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>

#include "reference/lights/kind.hpp"

namespace manylight::reference {
namespace {

// Of the angle at which a spot shines.
double cosine_to_axis(const Light& light, const glm::dvec3& towards) {
    return glm::dot(-towards, glm::normalize(glm::dvec3(light.axis)));
}

// The square root of what is left at an angle.
double cone(const Light& light, double versine) {
    return std::clamp((light.edge.y - versine) * light.edge.x, 0.0, 1.0);
}

Emission spot(const Light& light, const glm::dvec3& position, const glm::dvec2& /*u*/,
              const LightShift& shift) {
    Emission e = punctual(light, position);
    if (e.light == glm::dvec3(0)) return e;
    const double left = cone(light, 1 - cosine_to_axis(light, e.towards) + shift.versine);
    e.light *= left * left;
    return e;
}

// Of 1 - the cosine to the axis, sin^2 / (1 + cos): the sine is a cross product, off by 4 units,
// and 4 units of the whole.
std::vector<LightShift> shifts(const Light& light, const glm::dvec3& position) {
    const glm::dvec3 d = glm::dvec3(light.position) - position;
    if (d == glm::dvec3(0)) return {};
    const double cosine = cosine_to_axis(light, glm::normalize(d));
    const double sine = std::sqrt(std::max(1 - cosine * cosine, 0.0));
    const double off = 4 * unit_rounding * (2 * sine / (1 + std::max(cosine, 0.0)) + (1 - cosine));
    return {{.versine = off}};
}

double leaf(const Light& light, const glm::dvec3& to_centre, double /*softened*/) {
    const double versine = 1 - cosine_to_axis(light, glm::normalize(to_centre));
    return range_window(glm::length(to_centre), light.axis.w) * std::pow(cone(light, versine), 2);
}

}  // namespace

Kind kind_spot() { return {.emission = spot, .shifts = shifts, .leaf = leaf}; }

}  // namespace manylight::reference

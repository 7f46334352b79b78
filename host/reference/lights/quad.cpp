// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>

#include "reference/lights/kind.hpp"

namespace manylight::reference {
namespace {

// Of the cross product of an area's sides, m2: each part is a difference of two products.
double normal_rounding(const Light& light) {
    return 2 * unit_rounding * glm::length(glm::dvec3(light.axis)) *
           glm::length(glm::dvec3(light.edge));
}

}  // namespace

Emission parallelogram(const Light& light, const glm::dvec3& position, const glm::dvec2& u,
                       const LightShift& shift) {
    const glm::dvec3 e1(light.axis);
    const glm::dvec3 e2(light.edge);
    const glm::dvec3 n = glm::cross(e1, e2) + shift.normal;
    const double area = glm::length(n);
    // With radiance 1, what is received is the solid angle.
    Emission e = lambertian(position, glm::dvec3(light.position) + u.x * e1 + u.y * e2, n / area,
                            glm::dvec3(area), light.edge.w, light.axis.w != 0);
    e.solid_angle = e.light.x;
    // On which side the target is may be in doubt, too.
    const double turn = normal_rounding(light) / area;
    const bool doubtful = std::abs(glm::dot(e.towards, n)) <= turn * area;
    const glm::dvec3 p(light.position);
    const glm::dvec3 farthest = glm::max(glm::max(glm::abs(p), glm::abs(p + e1)),
                                         glm::max(glm::abs(p + e2), glm::abs(p + e1 + e2)));
    e.moved =
        4 * unit_rounding * farthest + light.edge.w * (doubtful ? 2 : std::min(2 * turn, 2.0));
    e.light *= glm::dvec3(light.emission);
    return e;
}

std::vector<LightShift> area_shifts(const Light& light, const glm::dvec3& /*position*/) {
    std::vector<LightShift> out(3);
    for (int axis = 0; axis < 3; ++axis) out[axis].normal[axis] = normal_rounding(light);
    return out;
}

double area_leaf(const Light& light, const glm::dvec3& to_centre, double softened) {
    const glm::dvec3 n = glm::normalize(glm::cross(glm::dvec3(light.axis), glm::dvec3(light.edge)));
    const double height = -glm::dot(to_centre, n);
    return (light.axis.w != 0 ? std::abs(height) : std::max(height, 0.0)) / std::sqrt(softened);
}

Kind kind_quad() { return {.emission = parallelogram, .shifts = area_shifts, .leaf = area_leaf}; }

}  // namespace manylight::reference

// SPDX-License-Identifier: MIT
#include "reference/light_tree.hpp"

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>

#include "reference/shading.hpp"

namespace manylight::reference {

double importance(const LightNode& node, const Surface& surface) {
    const glm::dvec3 normal(surface.normal);
    if (NODE_IS_INFINITE(node)) {
        const double cosine = glm::dot(normal, glm::dvec3(node.centre)) + double{node.intensity.w};
        return luminance(glm::dvec3(node.intensity)) * std::clamp(cosine, 0.0, 1.0);
    }
    const glm::dvec3 lower(node.lower);
    const glm::dvec3 upper(node.upper);
    const double radius = glm::length(upper - lower) / 2;
    const glm::dvec3 towards = (lower + upper) / 2.0 - glm::dvec3(surface.position);
    const double distance = glm::length(towards);
    if (std::max(distance, radius) == 0) return 0;
    const double base = double{node.cone.w} / std::pow(std::max(distance, radius), 2);
    if (distance <= radius) return base;
    const auto angle = [](double cosine) { return std::acos(std::clamp(cosine, -1.0, 1.0)); };
    const double by_bounds = std::asin(radius / distance);
    double emission = 1;
    if (node.upper.w <= 1) {
        const glm::dvec3 axis(node.cone);
        const double off_axis =
            std::max(std::atan2(glm::length(glm::cross(axis, towards)), -glm::dot(axis, towards)) -
                         angle(1 - double{node.lower.w}) - by_bounds,
                     0.0);
        if (off_axis > 0 && 1 - std::cos(off_axis) >= node.upper.w) return 0;
        emission = std::cos(off_axis);
    }
    const double incidence = std::max(angle(glm::dot(normal, towards / distance)) - by_bounds, 0.0);
    if (incidence >= glm::half_pi<double>()) return 0;
    return base * emission * std::cos(incidence);
}

}  // namespace manylight::reference

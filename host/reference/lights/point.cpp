// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>

#include "reference/lights/kind.hpp"

namespace manylight::reference {

double range_window(double distance, double range) {
    if (range == 0) return 1;
    return std::clamp(1 - std::pow(distance / range, 4), 0.0, 1.0);
}

Emission punctual(const Light& light, const glm::dvec3& position) {
    Emission e;
    e.target = glm::dvec3(light.position);
    const glm::dvec3 d = e.target - position;
    const double distance = glm::length(d);
    e.light = glm::dvec3(0);
    if (distance == 0) return e;
    e.towards = d / distance;
    e.light =
        glm::dvec3(light.emission) * (range_window(distance, light.axis.w) / (distance * distance));
    return e;
}

Kind kind_point() {
    return {.emission = [](const Light& light, const glm::dvec3& position, const glm::dvec2&,
                           const LightShift&) { return punctual(light, position); },
            .shifts = nullptr,
            .leaf = [](const Light& light, const glm::dvec3& to_centre,
                       double) { return range_window(glm::length(to_centre), light.axis.w); }};
}

}  // namespace manylight::reference

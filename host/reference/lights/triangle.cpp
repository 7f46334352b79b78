// SPDX-License-Identifier: MIT
#include "reference/lights/kind.hpp"

namespace manylight::reference {
namespace {

// Half a parallelogram.
Emission triangle(const Light& light, const glm::dvec3& position, const glm::dvec2& u,
                  const LightShift& shift) {
    // Which half of the square is decided in single precision.
    const bool beyond = static_cast<float>(u.x) + static_cast<float>(u.y) > 1;
    Emission e = parallelogram(light, position, beyond ? 1.0 - u : u, shift);
    e.light /= 2;
    e.solid_angle /= 2;
    return e;
}

}  // namespace

Kind kind_triangle() { return {.emission = triangle, .shifts = area_shifts, .leaf = area_leaf}; }

}  // namespace manylight::reference

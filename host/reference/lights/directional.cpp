// SPDX-License-Identifier: MIT
#include "reference/lights/kind.hpp"

namespace manylight::reference {
namespace {

Emission directional(const Light& light, const glm::dvec3& /*position*/, const glm::dvec2& /*u*/,
                     const LightShift& shift) {
    Emission e;
    e.towards = -glm::dvec3(light.axis) + shift.towards;
    e.target = glm::dvec3(0);
    e.light = glm::dvec3(light.emission);
    e.infinite = true;
    if (light.edge.y != 0) e.plane = light.edge.x;
    return e;
}

std::vector<LightShift> shifts(const Light& /*light*/, const glm::dvec3& /*position*/) {
    std::vector<LightShift> out(3);
    for (int axis = 0; axis < 3; ++axis) out[axis].towards[axis] = 4 * unit_rounding;
    return out;
}

}  // namespace

Kind kind_directional() { return {.emission = directional, .shifts = shifts, .leaf = nullptr}; }

}  // namespace manylight::reference

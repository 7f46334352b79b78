// SPDX-License-Identifier: MIT
#include "reference/lights/kind.hpp"

namespace manylight::reference {

Emission lambertian(const glm::dvec3& position, const glm::dvec3& point, glm::dvec3 normal,
                    const glm::dvec3& intensity, double offset, bool both_sides) {
    Emission e;
    e.light = glm::dvec3(0);
    e.target = point;
    const glm::dvec3 d = point - position;
    const double squared = glm::dot(d, d);
    if (squared == 0) return e;
    e.towards = d / std::sqrt(squared);
    double cosine = glm::dot(-e.towards, normal);
    if (cosine < 0 && both_sides) {
        cosine = -cosine;
        normal = -normal;
    }
    if (cosine <= 0) return e;
    e.light = intensity * cosine / squared;
    e.target += normal * offset;
    return e;
}

Kind kind_oriented() {
    return {.emission =
                [](const Light& light, const glm::dvec3& position, const glm::dvec2&,
                   const LightShift&) {
                    return lambertian(position, glm::dvec3(light.position), glm::dvec3(light.axis),
                                      glm::dvec3(light.emission), light.edge.w, false);
                },
            .shifts = nullptr,
            .leaf = nullptr};
}

}  // namespace manylight::reference

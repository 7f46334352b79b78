// SPDX-License-Identifier: MIT
// What a kind of light is to the reference, and what several kinds share.
#pragma once

#include <limits>

#include "reference/lights/lights.hpp"

namespace manylight::reference {

constexpr double unit_rounding = std::numeric_limits<float>::epsilon();

/// Its functions are those of lights.hpp; the last two may be missing.
struct Kind {
    Emission (*emission)(const Light& light, const glm::dvec3& position, const glm::dvec2& u,
                         const LightShift& shift);
    std::vector<LightShift> (*shifts)(const Light& light, const glm::dvec3& position);
    double (*leaf)(const Light& light, const glm::dvec3& to_centre, double softened);
};

#define LIGHT_KIND_OF(name, NAME, value, traits, centroid) [[nodiscard]] Kind kind_##name();
LIGHT_KINDS(LIGHT_KIND_OF)
#undef LIGHT_KIND_OF

/// KHR_lights_punctual's window of a light's range, if it has one (point.cpp).
[[nodiscard]] double range_window(double distance, double range);

/// A point with a range (point.cpp).
[[nodiscard]] Emission punctual(const Light& light, const glm::dvec3& position);

/// Intensity times cosine at `point` of an emitter with that unit normal (oriented.cpp).
[[nodiscard]] Emission lambertian(const glm::dvec3& position, const glm::dvec3& point,
                                  glm::dvec3 normal, const glm::dvec3& intensity, double offset,
                                  bool both_sides);

/// The point u of a parallelogram (quad.cpp), and the others of its functions.
[[nodiscard]] Emission parallelogram(const Light& light, const glm::dvec3& position,
                                     const glm::dvec2& u, const LightShift& shift);
[[nodiscard]] std::vector<LightShift> area_shifts(const Light& light, const glm::dvec3& position);
[[nodiscard]] double area_leaf(const Light& light, const glm::dvec3& to_centre, double softened);

}  // namespace manylight::reference

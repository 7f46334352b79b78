// SPDX-License-Identifier: MIT
#pragma once

#include <fmt/format.h>

#include <glm/vec3.hpp>
#include <limits>
#include <string>

namespace manylight {

/// Unit in the last place of 1, single precision.
constexpr double epsilon = std::numeric_limits<float>::epsilon();
/// One shading: some 40 operations, each rounded by half a unit, divisions and roots by 3.
constexpr double shading_roundings = 64;

constexpr const char* exact = "none: integers, or floats in a prescribed order";
constexpr const char* shading_tolerance =
    "64 eps per term (40 operations) + change under 8 eps shifts of the inputs";

[[nodiscard]] inline std::string show(const glm::dvec3& v) {
    return fmt::format("({:.9g}, {:.9g}, {:.9g})", v.x, v.y, v.z);
}

}  // namespace manylight

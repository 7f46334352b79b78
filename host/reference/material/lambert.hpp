// SPDX-License-Identifier: MIT
#pragma once

#include <glm/glm.hpp>
#include <glm/gtc/constants.hpp>

namespace manylight::reference {

/// Lambert's BRDF, 1/sr, of a base colour.
[[nodiscard]] inline glm::dvec3 lambert(const glm::dvec3& base) { return base / glm::pi<double>(); }

}  // namespace manylight::reference

// SPDX-License-Identifier: MIT
// Lights in words and as JSON, for the reports on them.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "scene/scene.hpp"

namespace manylight {

/// "point light 'lamp'", or its number where the file gives it no name: "quad light 12".
[[nodiscard]] std::string name_of(const Scene& scene, std::size_t light);

/// Where a light is in the file's frame, "(1.00, 2.00, 3.00)" in metres, or where a directional one
/// comes from. Of an area, its centroid.
[[nodiscard]] std::string place_of(const Scene& scene, std::size_t light);

/// light (its number), name, kind, position or direction (towards the light).
[[nodiscard]] nlohmann::json describe(const Scene& scene, std::size_t light);

/// "(1.00, 2.00, 3.00)".
[[nodiscard]] std::string show(const glm::dvec3& v);

/// [x, y, z].
[[nodiscard]] nlohmann::json vector_json(const glm::dvec3& v);

}  // namespace manylight

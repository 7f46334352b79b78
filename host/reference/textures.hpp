// SPDX-License-Identifier: MIT
#pragma once

#include "reference/tracing.hpp"

namespace manylight::reference {

/// A texture's value at (u, v), linear; `area` of its unit square is seen by a pixel, 0: as little
/// as may be.
[[nodiscard]] glm::dvec4 sample_texture(const Scene& scene, const Texture& texture,
                                        const glm::dvec2& uv, double area);

/// The material of the point where a ray hits: its triangle's times what the maps and vertex
/// colours say there. The ray's differentials choose the textures' levels.
[[nodiscard]] Material material_at(const Scene& scene, const Ray& ray, const Hit& hit);

/// How much is there, 0 to 1: the material's, its texture's at the finest level, the vertices'.
[[nodiscard]] double alpha_at(const Scene& scene, const Hit& hit);

/// The unit shading normal there that a normal map makes of `normal`, which is on the viewer's
/// side.
[[nodiscard]] glm::dvec3 normal_at(const Scene& scene, const Ray& ray, const Hit& hit,
                                   const glm::dvec3& normal);

}  // namespace manylight::reference

// SPDX-License-Identifier: MIT
#pragma once

#include "reference/tracing.hpp"
#include "shared/surface.h"
#include "shared/tiles.h"

namespace manylight::reference {

/// The primary ray through a point of the image, in pixels from its top left corner.
[[nodiscard]] Ray primary_ray(const Camera& camera, const Tiles& tiles, const glm::dvec2& point);

/// The surface at a hit of a ray, in double precision rounded once.
[[nodiscard]] Surface surface_at(const Scene& scene, const Ray& ray, const std::optional<Hit>& hit);

/// Gives the surface at a hit of a ray the material that it has of its own, behind the scene's.
void own_material(Scene& scene, const Ray& ray, const std::optional<Hit>& hit, Surface& surface);

/// Stage gbuffer for one pixel; `jitter` false: through its centre.
[[nodiscard]] Surface gbuffer(const Scene& scene, const Tracer& tracer, const Camera& camera,
                              const Tiles& tiles, uint x, uint y, bool jitter, uint pixel_sample,
                              uint seed);

/// The point of the image, in pixels, that a pixel sample lies at.
[[nodiscard]] glm::dvec2 sample_point(const Tiles& tiles, uint x, uint y, bool jitter,
                                      uint pixel_sample, uint seed);

}  // namespace manylight::reference

// SPDX-License-Identifier: MIT
#pragma once

#include "scene/scene.hpp"
#include "shared/surface.h"

namespace manylight::reference {

/// Stage accumulate: what one sample adds to its pixel's sum. `seen`: by stage emitter_parts.
[[nodiscard]] inline glm::dvec4 pixel_sample_value(const Surface& surface, const float4& estimate,
                                                   const Scene& scene,
                                                   const float4& seen = float4(0, 0, 0, 1)) {
    glm::dvec4 value = glm::dvec4(estimate) + glm::dvec4(glm::vec3(seen), 0);
    if (surface.position.w < 0 || seen.w == 0) return value;
    const float4& emission = scene.materials[surface.shading].emission;
    if (surface.front || emission.w != 0) value += glm::dvec4(glm::vec3(emission), 0);
    return value;
}

}  // namespace manylight::reference

// SPDX-License-Identifier: MIT
#pragma once

#include "scene/scene.hpp"
#include "shared/surface.h"

namespace manylight::reference {

/// Stage accumulate: a pixel's sum after one more sample.
[[nodiscard]] inline float4 accumulated(float4 sum, const Surface& surface, const float4& estimate,
                                        const Scene& scene) {
    sum += estimate;
    if (surface.position.w < 0) return sum;
    const float4& emission = scene.materials[surface.material].emission;
    if (surface.front || emission.w != 0) sum += float4(glm::vec3(emission), 0);
    return sum;
}

}  // namespace manylight::reference

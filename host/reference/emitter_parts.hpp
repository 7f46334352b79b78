// SPDX-License-Identifier: MIT
#pragma once

#include "reference/tracing.hpp"
#include "shared/emitter_part.h"
#include "shared/tiles.h"

namespace manylight::reference {

/// What a point drawn on a part of an emitter gives its pixel.
struct PartLight {
    glm::dvec3 value{0};  // cd/m2, where nothing is in the way
    double slack = 0;     // of rounding
    Ray shadow;           // from the near plane to the point
    EndShifts rounding;   // of that
};

/// Stage emitter_parts for one part, part `number` of those that are drawn in every stride-th pixel
/// sample.
[[nodiscard]] PartLight part_light(const Scene& scene, const Camera& camera, const Tiles& tiles,
                                   const EmitterPart& part, uint number, uint stride,
                                   uint pixel_sample, uint seed);

}  // namespace manylight::reference

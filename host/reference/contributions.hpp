// SPDX-License-Identifier: MIT
#pragma once

#include <span>

#include "reference/shading.hpp"
#include "shared/contribution.h"

namespace manylight::reference {

/// C(a, y) of paper eq. (4).
struct Contribution {
    double value;  // luminance with V = 1, cd/m2
    bool hidden;
    Ray shadow;          // meaningful where value > 0
    EndShifts rounding;  // of the shadow ray
};

/// Stage contributions: one light at one representative; area lights by their centroid.
[[nodiscard]] Contribution contribution(const Tracer& tracer, const Surface& representative,
                                        const Material& material, const Viewer& viewer,
                                        const Light& light);

/// Where stage contributions samples a light, in [0, 1)^2: the centroid of an area light.
[[nodiscard]] glm::dvec2 centroid(const Light& light);

/// A row's sums, from its entries as stored (negative: hidden).
struct RowTotal {
    double visible, unshadowed;
    uint visible_count, facing_count;
};
[[nodiscard]] RowTotal row_total(std::span<const float> row);

}  // namespace manylight::reference

// SPDX-License-Identifier: MIT
// Stage seen_lights: what kernels/samplers/adaptive/seen_lights.cl computes.
#pragma once

#include <span>

#include "reference/samples.hpp"
#include "reference/tracing.hpp"

namespace manylight::reference {

struct SeenLight {
    bool seen = false;
    bool uncertain = false;  // rounding may decide otherwise
};

/// Whether any of `most_rays` shadow rays passes that start on surfaces, a power of two of them, in
/// an order of light number `number`'s own, and end on its centroid. Surfaces that miss the scene,
/// and those that it does not shine on, have none.
[[nodiscard]] SeenLight find_seen_light(const Tracer& tracer, const Scene& scene,
                                        const Viewers& view, std::span<const Surface> surfaces,
                                        const Light& light, uint number, uint most_rays, uint seed);

}  // namespace manylight::reference

// SPDX-License-Identifier: MIT
#include "reference/contributions.hpp"

namespace manylight::reference {

Contribution contribution(const Tracer& tracer, const Surface& representative,
                          const Material& material, const Viewer& viewer, const Light& light) {
    const Unshadowed u = unshadowed(representative, material, viewer, light, centroid(light));
    Contribution c{luminance(u.value), false, u.shadow, u.rounding};
    if (c.value > 0) c.hidden = tracer.occluded(u.shadow);
    return c;
}

glm::dvec2 centroid(const Light& light) {
    return glm::dvec2(1.0 / light_centroid_parts(static_cast<uint>(light.position.w)));
}

RowTotal row_total(std::span<const float> row) {
    RowTotal total{};
    for (const float entry : row) {
        if (entry == 0) continue;
        ++total.facing_count;
        total.unshadowed += std::abs(entry);
        if (entry < 0) continue;
        ++total.visible_count;
        total.visible += entry;
    }
    return total;
}

}  // namespace manylight::reference

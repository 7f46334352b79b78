// SPDX-License-Identifier: MIT
#include "reference/contributions.hpp"

namespace manylight::reference {

Contribution contribution(const Tracer& tracer, const Surface& representative,
                          const Material& material, const Camera& camera, const Light& light) {
    const Unshadowed u = unshadowed(representative, material, camera, light, centroid);
    Contribution c{luminance(u.value), false, u.shadow};
    if (c.value > 0) c.hidden = tracer.occluded(u.shadow);
    return c;
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

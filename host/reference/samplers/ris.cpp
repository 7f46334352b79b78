// SPDX-License-Identifier: MIT
#include "reference/samplers/ris.hpp"

#include "reference/random.hpp"
#include "shared/ris.h"

namespace manylight::reference {

Choice ByCandidates::choose(const Point& point, const Draw& draw) const {
    const glm::dvec2 u(unit_fraction(draw.bits[1]), unit_fraction(draw.bits[2]));
    const uint total = power_cdf_.back();
    if (total == 0) return {0, 0};
    Choice choice{0, 0};
    double sum = 0;
    double chosen = 0;
    double slack = 0;
    for (uint i = 0; i < CANDIDATES; ++i) {
        const uint target = stratified(total, i * draw.sample_count + draw.sample,
                                       CANDIDATES * draw.sample_count, step_bits(draw.bits[0], i));
        const Found found = search(power_cdf_, target);
        const double contribution =
            luminance(unshadowed(point.surface, point.material(), point.viewer,
                                 point.scene.lights[found.light], u)
                          .value);
        const double weight = contribution / found.width;
        sum += weight;
        if (draw.judge)
            slack += rounding_slack(point.surface, point.material(), point.viewer,
                                    point.scene.lights[found.light], u) /
                     found.width;
        if (sum == 0) continue;
        const double share = weight / sum - unit_fraction(step_bits(draw.bits[3], i));
        if (weight > 0 && std::abs(share) < doubtful_draw) choice.borderline = true;
        if (share <= 0) continue;
        choice.light = found.light;
        chosen = contribution;
    }
    if (chosen == 0) return choice;
    choice.weight = sum * total / (chosen * CANDIDATES * draw.sample_count);
    choice.slack = slack / sum;
    return choice;
}

}  // namespace manylight::reference

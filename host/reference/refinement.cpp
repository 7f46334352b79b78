// SPDX-License-Identifier: MIT
#include "reference/refinement.hpp"

#include <algorithm>

namespace manylight::reference {
namespace {

enum class Light { none, shadow, lit };  // none: no light faces the representative

Light lighting(const RowSum& total, bool weighed, float threshold) {
    if (total.facing_count == 0) return Light::none;
    if (weighed) return total.visible < threshold * total.unshadowed ? Light::shadow : Light::lit;
    const float needed = threshold * static_cast<float>(total.facing_count);
    return static_cast<float>(total.visible_count) < needed ? Light::shadow : Light::lit;
}

}  // namespace

std::vector<uint> split_by_visibility(std::span<const Region> regions,
                                      std::span<const RowSum> totals, bool weighed, float threshold,
                                      uint max_level) {
    std::vector<uint> split(regions.size(), 0);
    for (std::size_t i = 0; i < regions.size(); ++i) {
        const Region& region = regions[i];
        if (region.level >= max_level || region.size < 2) continue;
        if (lighting(totals[i], weighed, threshold) != Light::shadow) continue;
        const auto siblings = totals.subspan(region.first_sibling, region.siblings);
        const bool one_is_lit = std::ranges::any_of(siblings, [&](const RowSum& s) {
            return lighting(s, weighed, threshold) == Light::lit;
        });
        const bool umbra = region.siblings > 0 && !one_is_lit;
        split[i] = umbra ? 0 : 1;
    }
    return split;
}

}  // namespace manylight::reference

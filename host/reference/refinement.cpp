// SPDX-License-Identifier: MIT
#include "reference/refinement.hpp"

#include <algorithm>

namespace manylight::reference {
namespace {

enum class Light { none, shadow, lit };  // none: no light faces the representative

Light lighting(const RowSum& total, float threshold) {
    if (total.facing_count == 0) return Light::none;
    const float needed = threshold * static_cast<float>(total.facing_count);
    return static_cast<float>(total.visible_count) < needed ? Light::shadow : Light::lit;
}

}  // namespace

std::vector<uint> split_by_visibility(std::span<const Region> regions,
                                      std::span<const RowSum> totals, float threshold,
                                      uint max_level) {
    std::vector<uint> split(regions.size(), 0);
    for (std::size_t i = 0; i < regions.size(); ++i) {
        const Region& region = regions[i];
        if (region.level >= max_level || region.size < 2) continue;
        if (lighting(totals[i], threshold) != Light::shadow) continue;
        const auto siblings = totals.subspan(region.first_sibling, region.siblings);
        const bool one_is_lit = std::ranges::any_of(
            siblings, [&](const RowSum& s) { return lighting(s, threshold) == Light::lit; });
        const bool umbra = region.siblings > 0 && !one_is_lit;
        split[i] = umbra ? 0 : 1;
    }
    return split;
}

}  // namespace manylight::reference

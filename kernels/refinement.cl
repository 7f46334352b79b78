// SPDX-License-Identifier: MIT
// Stage refinement: which clusters in shadow are split (paper 4.1, umbra and penumbra).
#include "lib/common.h"
#include "shared/contribution.h"
#include "shared/tiles.h"

// A cluster is in shadow where its representative sees less than `threshold` of the lights that
// face it, counted (the paper's way) or weighed by what they would contribute; one that no light
// faces says nothing.
static bool in_shadow(RowSum total, uint weighed, float threshold) {
    if (total.facing_count == 0u) return false;
    return weighed ? total.visible < threshold * total.unshadowed
                   : (float)total.visible_count < threshold * (float)total.facing_count;
}

// split[i] = 1 where region i of first..first + count is to be split: it is in shadow and above the
// maximum depth, unless its siblings from an earlier visibility split all are (an umbra).
// totals[region].
KERNEL void refinement_split(__global const Region* regions, __global const RowSum* totals,
                             uint first, uint count, uint weighed, float threshold, uint max_level,
                             __global uint* split) {
    const uint i = get_global_id(0);
    if (i >= count) return;
    const Region region = regions[first + i];
    bool umbra = region.siblings != 0u;
    for (uint s = 0u; s < region.siblings; ++s) {
        const RowSum sibling = totals[region.first_sibling + s];
        if (sibling.facing_count != 0u && !in_shadow(sibling, weighed, threshold)) umbra = false;
    }
    const bool divisible = region.level < max_level && region.size >= 2u;
    const bool dark = in_shadow(totals[first + i], weighed, threshold);
    split[first + i] = divisible && !umbra && dark ? 1u : 0u;
}

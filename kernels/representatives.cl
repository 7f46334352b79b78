// SPDX-License-Identifier: MIT
// Stage representatives: the pixel that stands for each region (paper 4.1).
#include "lib/tiles.h"
#include "shared/surface.h"

// representatives[region] = item of the pixel at the region's centre; where that missed the scene,
// of the nearest pixel of the region that did not (the first in row order of several), or NO_ITEM.
KERNEL void representatives_pick(Tiles tiles, __global const Region* regions, uint first,
                                 uint count, __global const Surface* surfaces,
                                 __global uint* representatives) {
    const uint i = get_global_id(0);
    if (i >= count) return;
    const Region region = regions[first + i];
    const uint end_x = min(region.x + region.size, tiles.width);
    const uint end_y = min(region.y + region.size, tiles.height);
    const uint centre_x = min(region.x + region.size / 2u, end_x - 1u);
    const uint centre_y = min(region.y + region.size / 2u, end_y - 1u);
    uint best = pixel_item(tiles, centre_x, centre_y);
    if (surfaces[best].position.w < 0.0f) {
        best = NO_ITEM;
        uint best_distance = 0xffffffffu;
        for (uint y = region.y; y < end_y; ++y)
            for (uint x = region.x; x < end_x; ++x) {
                const uint item = pixel_item(tiles, x, y);
                const uint dx = abs_diff(x, centre_x);
                const uint dy = abs_diff(y, centre_y);
                const uint distance = dx * dx + dy * dy;
                if (distance >= best_distance || surfaces[item].position.w < 0.0f) continue;
                best = item;
                best_distance = distance;
            }
    }
    representatives[first + i] = best;
}

// SPDX-License-Identifier: MIT
// Stage clusters: the quadtree of each tile, split by corner normals (paper 4.1).
#include "lib/tiles.h"
#include "shared/surface.h"

static bool normals_differ(__global const Surface* a, __global const Surface* b,
                           float cos_threshold) {
    const bool a_missed = a->position.w < 0.0f;
    const bool b_missed = b->position.w < 0.0f;
    if (a_missed || b_missed) return a_missed != b_missed;
    const float cosine =
        a->normal.x * b->normal.x + a->normal.y * b->normal.y + a->normal.z * b->normal.z;
    return cosine < cos_threshold;
}

// split[region] = 1 where two of the four corner pixels differ and the region can be split.
KERNEL void clusters_split(Tiles tiles, __global const Region* regions, uint region_count,
                           __global const Surface* surfaces, float cos_threshold, uint max_level,
                           __global uint* split) {
    const uint i = get_global_id(0);
    if (i >= region_count) return;
    const Region region = regions[i];
    split[i] = 0u;
    if (region.level >= max_level || region.size < 2u) return;
    const uint right = min(region.x + region.size, tiles.width) - 1u;
    const uint bottom = min(region.y + region.size, tiles.height) - 1u;
    __global const Surface* corners[4] = {
        surfaces + pixel_item(tiles, region.x, region.y),
        surfaces + pixel_item(tiles, right, region.y),
        surfaces + pixel_item(tiles, region.x, bottom),
        surfaces + pixel_item(tiles, right, bottom),
    };
    for (uint a = 0u; a < 3u; ++a)
        for (uint b = a + 1u; b < 4u; ++b)
            if (normals_differ(corners[a], corners[b], cos_threshold)) split[i] = 1u;
}

// item_rows[item] = index of the region, and so of the matrix row, that the item's pixel lies in,
// among those that were not split.
KERNEL void clusters_assign(Tiles tiles, __global const Region* regions, uint region_count,
                            __global const uint* split, __global uint* item_rows) {
    const uint i = get_global_id(0);
    if (i >= region_count || split[i]) return;
    const Region region = regions[i];
    for (uint y = region.y; y < min(region.y + region.size, tiles.height); ++y)
        for (uint x = region.x; x < min(region.x + region.size, tiles.width); ++x)
            item_rows[pixel_item(tiles, x, y)] = i;
}

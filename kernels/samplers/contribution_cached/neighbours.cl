// SPDX-License-Identifier: MIT
// Stage neighbours of sampler contribution-cached: which clusters are near a cluster.
#include "lib/common.h"
#include "lib/tiles.h"
#include "samplers/contribution_cached/nearest.h"
#include "shared/surface.h"

// neighbours[MOST_NEIGHBOURS * row + i]: the clusters in a cluster's tile and the eight about it,
// as far as they are in the batch, that have a representative of a similar normal, nearest first by
// the representatives' distance; NO_ROW where there are no more. places[row].xyz: where its
// representative is. clusters[tile_first[tile] to tile_first[tile + 1]]: rows of the clusters in a
// tile of the batch, in their order.
KERNEL void neighbours_find(Tiles tiles, __global const Region* regions,
                            __global const uint* clusters, uint cluster_count,
                            __global const uint* tile_first, __global const uint* representatives,
                            __global const Surface* surfaces, float least_cosine,
                            __global uint* neighbours, __global float4* places) {
    const uint i = get_global_id(0);
    if (i >= cluster_count) return;
    const uint row = clusters[i];
    Nearest nearest;
    nearest.count = 0u;
    places[row] = (float4)(0.0f);
    if (representatives[row] != NO_ITEM) {
        const float3 position = surfaces[representatives[row]].position.xyz;
        const float3 normal = surfaces[representatives[row]].normal.xyz;
        places[row] = (float4)(position, 0.0f);
        const int column = (int)(regions[row].x / tiles.size);
        const int line = (int)(regions[row].y / tiles.size);
        for (int y = line - 1; y <= line + 1; ++y)
            for (int x = max(column - 1, 0); x <= min(column + 1, (int)tiles.columns - 1); ++x) {
                const int tile = y * (int)tiles.columns + x - (int)tiles.first;
                if (tile < 0 || tile >= (int)tiles.count) continue;
                for (uint k = tile_first[tile]; k < tile_first[tile + 1]; ++k) {
                    const uint other = clusters[k];
                    if (other == row || representatives[other] == NO_ITEM) continue;
                    __global const Surface* s = surfaces + representatives[other];
                    if (dot(normal, s->normal.xyz) < least_cosine) continue;
                    const float3 apart = s->position.xyz - position;
                    add_row(&nearest, MOST_NEIGHBOURS, other, dot(apart, apart));
                }
            }
    }
    for (uint k = 0u; k < MOST_NEIGHBOURS; ++k)
        neighbours[MOST_NEIGHBOURS * (ulong)row + k] = k < nearest.count ? nearest.rows[k] : NO_ROW;
}

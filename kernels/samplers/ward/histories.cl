// SPDX-License-Identifier: MIT
// Stage histories: how often a tile's pixels see each light, before any pixel is drawn.
#include "lib/draw.h"
#include "samplers/ward/walk.h"

// histories[tile * light_count + light] (shared/ward.h). One tile and light per work-item.
KERNEL void ward_probe(Tiles tiles, VIEW_PARAMETERS, __global const Surface* surfaces,
                       __global const Material* materials, __global const Light* lights,
                       uint light_count, uint seed, BVH_PARAMETERS, __global uint* histories) {
    const ulong i = get_global_id(0);
    if (i >= (ulong)tiles.count * light_count) return;
    const uint tile = (uint)(i / light_count), index = (uint)(i % light_count);
    const uint area = tiles.size * tiles.size;
    const uint4 bits = random_bits(tiles.first + tile, RANDOM_HISTORIES, index, seed);
    __global const Light* light = lights + index;
    uint history = 0u;
    for (uint probe = 0u; probe < WARD_PROBES; ++probe) {
        const uint item =
            tile * area + stratified_below(area, probe, WARD_PROBES, step_bits(bits.x, probe));
        if (!item_in_image(tiles, item) || surface_missed(surfaces + item)) continue;
        const Receiver receiver = make_receiver(surfaces, item, materials, VIEW);
        const float2 u =
            (float2)(unit_float(step_bits(bits.y, probe)), unit_float(step_bits(bits.z, probe)));
        Ray shadow;
        const float3 value = unshadowed(&receiver, light, u, &shadow);
        if (!any(value != 0.0f)) continue;
        history += occluded(BVH_ARGUMENTS, shadow) ? 1u : 65537u;
    }
    histories[i] = history;
}

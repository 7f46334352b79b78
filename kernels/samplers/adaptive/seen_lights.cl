// SPDX-License-Identifier: MIT
// Stage seen_lights: a first look at which lights shine on anything that the image shows.
#include "lib/direct.h"
#include "lib/random.h"
#include "lib/tiles.h"

// The dimension of the random numbers of the first look.
#define RANDOM_LOOK 0xfffffffbu

// seen[light]: 1 where a shadow ray from one of the points reaches it, 0 where `most_rays` did not.
// Points are the surfaces of `tiles`, which are a power of two, in an order of the light's own. One
// light per work-item.
KERNEL void seen_lights_find(Tiles tiles, VIEW_PARAMETERS, __global const Surface* surfaces,
                             __global const Material* materials, __global const Light* lights,
                             uint light_count, uint most_rays, uint seed, BVH_PARAMETERS,
                             __global uint* seen) {
    const uint light = get_global_id(0);
    if (light >= light_count) return;
    const uint points = tiles.count * tiles.size * tiles.size;
    const uint4 bits = random_bits(light, 0u, RANDOM_LOOK, seed);
    const float2 u = light_centroid(lights + light);
    uint rays = 0u;
    seen[light] = 0u;
    for (uint i = 0u; i < points && rays < most_rays; ++i) {
        const uint item = (bits.x + i * (bits.y | 1u)) & (points - 1u);
        if (surface_missed(surfaces + item)) continue;
        const Receiver receiver = make_receiver(surfaces, item, materials, VIEW);
        Ray shadow;
        if (!any(unshadowed(&receiver, lights + light, u, &shadow) != 0.0f)) continue;
        ++rays;
        if (occluded(BVH_ARGUMENTS, shadow)) continue;
        seen[light] = 1u;
        return;
    }
}

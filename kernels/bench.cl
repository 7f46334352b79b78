// SPDX-License-Identifier: MIT
// Closest hits alone, for manylight bench and for tests; rays as in lib/rays.h.
#include "lib/rays.h"
#include "lib/trace_packet.h"

// Beyond starts[16 * packet + lane]. triangles[16 * packet + lane], ~0 where nothing is hit; where
// something is, the ray's end becomes the hit's t. One packet per work-item.
#if LANES > 1
KERNEL void bench_closest_packets(BVH_PARAMETERS, __global const float4* origins,
                                  __global float* rays, __global const float* starts,
                                  uint packet_count, __global uint* triangles) {
    const uint i = get_global_id(0);
    if (i >= packet_count) return;
    Packet packet = load_packet(origins, rays, i);
    float_n from[PARTS];
    for (uint part = 0u; part < PARTS; ++part)
        from[part] = *(__global const float_n*)(starts + 16u * i + LANES * part);
    int_n found[PARTS];
    closest_hits(BVH_ARGUMENTS, &packet, from, found);
    for (uint part = 0u; part < PARTS; ++part)
        *(__global uint_n*)(triangles + 16u * i + LANES * part) = as_uint_n(found[part]);
    store_ends(&packet, rays, i);
}
#endif

KERNEL void bench_closest_rays(BVH_PARAMETERS, __global const float4* origins, __global float* rays,
                               __global const float* starts, uint packet_count,
                               __global uint* triangles) {
    const uint i = get_global_id(0);
    if (i / 16u >= packet_count) return;
    __global float* lane = rays + 64 * (ulong)(i / 16u) + i % 16u;
    const Ray ray = {origins[i / 16u].xyz, (float3)(lane[0], lane[16], lane[32]), lane[48]};
    const Hit hit = closest_hit(BVH_ARGUMENTS, ray, starts[i]);
    triangles[i] = hit.triangle;
    lane[48] = hit.t;
}

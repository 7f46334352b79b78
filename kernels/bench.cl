// SPDX-License-Identifier: MIT
// Closest hits alone, for manylight bench and for tests; rays as in lib/rays.h.
#include "lib/packet.h"

// triangles[16 * packet + lane], ~0 where nothing is hit; where something is, the ray's end becomes
// the hit's t.
KERNEL void bench_closest_packets(BVH_PARAMETERS, __global const float4* origins,
                                  __global float16* rays, uint packet_count,
                                  __global int16* triangles) {
    const uint i = get_global_id(0);
    if (i >= packet_count) return;
    __global float16* ray = rays + 4 * (ulong)i;
    Packet packet = make_packet(origins[i].xyz, ray[0], ray[1], ray[2], ray[3]);
    int16 found;
    closest_hits(BVH_ARGUMENTS, &packet, &found);
    triangles[i] = found;
    ray[3] = packet.end;
}

KERNEL void bench_closest_rays(BVH_PARAMETERS, __global const float4* origins, __global float* rays,
                               uint packet_count, __global uint* triangles) {
    const uint i = get_global_id(0);
    if (i / 16u >= packet_count) return;
    __global float* lane = rays + 64 * (ulong)(i / 16u) + i % 16u;
    const Ray ray = {origins[i / 16u].xyz, (float3)(lane[0], lane[16], lane[32]), lane[48]};
    const Hit hit = closest_hit(BVH_ARGUMENTS, ray);
    triangles[i] = hit.triangle;
    lane[48] = hit.t;
}

// SPDX-License-Identifier: MIT
// Stage shadows: finds the rays (lib/rays.h) that something is in the way of.
#include "lib/rays.h"
#include "lib/trace_packet.h"

// Where packets come in regions, only the first packet_counts[region] of each are in use.
#if HAS_REGIONS
#define REGIONS __global const uint *packet_counts, uint region,
#define IS_UNUSED(packet) ((packet) % region >= packet_counts[(packet) / region])
#else
#define REGIONS
#define IS_UNUSED(packet) ((packet) >= packet_count)
#endif

#if LANES > 1
// One packet per work-item.
KERNEL void shadows_trace_packets(BVH_PARAMETERS, __global const float4* origins,
                                  __global float* rays, REGIONS uint packet_count) {
    const uint i = get_global_id(0);
    if (i >= packet_count) return;
    if (IS_UNUSED(i)) return;
    Packet packet = load_packet(origins, rays, i);
    if (rays_of(&packet) && occlude_packet(BVH_ARGUMENTS, &packet)) store_ends(&packet, rays, i);
}
#endif

// The same, one ray per work-item.
KERNEL void shadows_trace_rays(BVH_PARAMETERS, __global const float4* origins, __global float* rays,
                               REGIONS uint packet_count) {
    const uint i = get_global_id(0);
    if (i / 16u >= packet_count) return;
    if (IS_UNUSED(i / 16u)) return;
    __global float* row = rays + 64 * (ulong)(i / 16u) + i % 16u;
    const Ray ray = {origins[i / 16u].xyz, (float3)(row[0], row[16], row[32]), row[48]};
    if (ray.end > 0.0f && occluded(BVH_ARGUMENTS, ray)) row[48] = -1.0f;
}

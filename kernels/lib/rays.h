// SPDX-License-Identifier: MIT
// Buffers of shadow rays, which stage shadows traces: packets of 16 that share origins[packet].xyz.
// rays[64 * packet + 16 * row + lane] holds, in rows 0 to 2, a direction and, in row 3, where the
// segment origin + t direction ends; 0: the lane holds no ray; negative: it did, and is occluded.
#ifndef MANYLIGHT_LIB_RAYS_H
#define MANYLIGHT_LIB_RAYS_H

#include "lib/packet.h"

#define RAY_END(rays, packet, lane) (rays)[64 * (ulong)(packet) + 48 + (lane)]

// Empties a packet.
static void clear_packet(__global float* rays, ulong packet) {
    for (uint lane = 0u; lane < 16u; lane += LANES)
        *(__global float_n*)(rays + 64 * packet + 48 + lane) = (float_n)(0.0f);
}

#if LANES > 1
// LANES rays of a packet, of which `row` points to the first's direction's x.
static Packet load_packet(__global const float4* origins, __global const float* row, uint packet) {
    __global const float_n* lanes = (__global const float_n*)row;
    return make_packet(origins[packet].xyz, lanes[0], lanes[16 / LANES], lanes[32 / LANES],
                       lanes[48 / LANES]);
}
#endif

// Puts a ray in a lane, but for its origin.
static void put_ray(__global float* rays, ulong packet, uint lane, Ray ray) {
    __global float* row = rays + 64 * packet + lane;
    row[0] = ray.direction.x;
    row[16] = ray.direction.y;
    row[32] = ray.direction.z;
    row[48] = ray.end;
}

#endif

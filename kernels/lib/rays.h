// SPDX-License-Identifier: MIT
// Buffers of shadow rays, which stage shadows traces: packets of 16 that share origins[packet].xyz.
// rays[64 * packet + 16 * row + lane] holds, in rows 0 to 2, a direction and, in row 3, where the
// segment origin + t direction ends; 0: the lane holds no ray; negative: it did, and is occluded.
#ifndef MANYLIGHT_LIB_RAYS_H
#define MANYLIGHT_LIB_RAYS_H

#include "lib/trace_packet.h"

#define RAY_END(rays, packet, lane) (rays)[64 * (ulong)(packet) + 48 + (lane)]

// Empties a packet.
static void clear_packet(__global float* rays, ulong packet) {
    for (uint lane = 0u; lane < 16u; lane += LANES)
        *(__global float_n*)(rays + 64 * packet + 48 + lane) = (float_n)(0.0f);
}

#if LANES > 1
static Packet load_packet(__global const float4* origins, __global const float* rays, uint packet) {
    __global const float_n* rows = (__global const float_n*)(rays + 64 * (ulong)packet);
    Packet p;
    p.origin = origins[packet].xyz;
    for (uint i = 0u; i < PARTS; ++i) {
        p.x[i] = rows[i];
        p.y[i] = rows[PARTS + i];
        p.z[i] = rows[2 * PARTS + i];
        p.end[i] = rows[3 * PARTS + i];
    }
    prepare_packet(&p);
    return p;
}

static void store_ends(const Packet* p, __global float* rays, uint packet) {
    for (uint i = 0u; i < PARTS; ++i)
        *(__global float_n*)(&RAY_END(rays, packet, LANES * i)) = p->end[i];
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

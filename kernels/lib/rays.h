// SPDX-License-Identifier: MIT
// Buffers of shadow rays, which stage shadows traces: packets of 16 that share origins[packet].xyz.
// rays[64 * packet + 16 * row + lane] holds, in rows 0 to 2, a direction and, in row 3, where the
// segment origin + t direction ends; 0: the lane holds no ray; negative: it did, and is occluded.
#ifndef MANYLIGHT_LIB_RAYS_H
#define MANYLIGHT_LIB_RAYS_H

#include "lib/bvh.h"

#define RAY_END(rays, packet, lane) (rays)[64 * (ulong)(packet) + 48 + (lane)]

// Empties a packet.
static void clear_packet(__global float* rays, ulong packet) {
    *(__global float16*)(rays + 64 * packet + 48) = (float16)(0.0f);
}

// Puts a ray in a lane, but for its origin.
static void put_ray(__global float* rays, ulong packet, uint lane, Ray ray) {
    __global float* row = rays + 64 * packet + lane;
    row[0] = ray.direction.x;
    row[16] = ray.direction.y;
    row[32] = ray.direction.z;
    row[48] = ray.end;
}

#endif

// SPDX-License-Identifier: MIT
// 16 rays with one origin against the wide BVH of lib/bvh.h, by one work-item. Sets of rays are
// integers, 1 << lane.
#ifndef MANYLIGHT_LIB_PACKET_H
#define MANYLIGHT_LIB_PACKET_H

#include "lib/bvh.h"

// So many rays, or fewer, are tested one by one against all of a node's children at once, instead
// of all at once against one child after another.
#define PACKET_FEW 8

#define LANE(vector, lane) (((const float*)&(vector))[lane])
#define SET_LANE(vector, lane, value) ((float*)&(vector))[lane] = (value)

// Segments origin + t direction, 0 < t < end; a lane whose end is not positive holds no ray.
typedef struct Packet {
    float3 origin;
    float16 x, y, z;     // directions
    float16 ix, iy, iz;  // their inverses
    float16 size;        // largest part of the directions
    float16 end;
    // Bounds of the inverses over all rays, and of where rays end, for tests of all at once; on an
    // axis along which directions differ in sign, nothing is bounded and the mask is 0.
    float3 lowest, highest;
    float furthest;
} Packet;

static float16 safe_inverse_16(float16 d) {
    return 1.0f / select(d, copysign((float16)(1e-20f), d), fabs(d) < 1e-20f);
}

static float lowest_of(float16 v) {
    const float8 a = min(v.lo, v.hi);
    const float4 b = min(a.lo, a.hi);
    const float2 c = min(b.lo, b.hi);
    return min(c.x, c.y);
}

static float highest_of(float16 v) { return -lowest_of(-v); }

static void bound_axis(float16 inverse, int16 none, float* lowest, float* highest) {
    *lowest = lowest_of(select(inverse, (float16)(INFINITY), none));
    *highest = highest_of(select(inverse, (float16)(-INFINITY), none));
}

static Packet make_packet(float3 origin, float16 x, float16 y, float16 z, float16 end) {
    Packet p;
    p.origin = origin;
    p.x = x;
    p.y = y;
    p.z = z;
    p.end = end;
    p.ix = safe_inverse_16(x);
    p.iy = safe_inverse_16(y);
    p.iz = safe_inverse_16(z);
    p.size = max(max(fabs(x), fabs(y)), fabs(z));
    const int16 none = !(end > 0.0f);
    float low, high;
    bound_axis(p.ix, none, &low, &high);
    p.lowest.x = low;
    p.highest.x = high;
    bound_axis(p.iy, none, &low, &high);
    p.lowest.y = low;
    p.highest.y = high;
    bound_axis(p.iz, none, &low, &high);
    p.lowest.z = low;
    p.highest.z = high;
    p.furthest = highest_of(end);
    return p;
}

static float3 direction_of(const Packet* p, uint lane) {
    return (float3)(LANE(p->x, lane), LANE(p->y, lane), LANE(p->z, lane));
}

static Prepared prepared_of(const Packet* p, uint lane) {
    return prepare(p->origin, (float3)(LANE(p->ix, lane), LANE(p->iy, lane), LANE(p->iz, lane)));
}

// Where any ray may enter and leave the slabs of an axis, given bounds of the inverses: planes are
// relative to the origin.
static void bound_slabs(float_w lower, float_w upper, float low, float high, float_w* entry,
                        float_w* leave) {
    if (low > 0.0f) {  // all rays go up: they enter at `lower`
        *entry = max(*entry, min(lower * low, lower * high));
        *leave = min(*leave, max(upper * low, upper * high));
    } else if (high < 0.0f) {
        *entry = max(*entry, min(upper * low, upper * high));
        *leave = min(*leave, max(lower * low, lower * high));
    }
}

// The children that any ray may enter; `entry` gets where, at the earliest.
static uint may_enter_children(__global const float_w* node, const Packet* p, float_w* entry) {
    *entry = (float_w)(0.0f);
    float_w leave = (float_w)(p->furthest);
    bound_slabs(node[0] - p->origin.x, node[3] - p->origin.x, p->lowest.x, p->highest.x, entry,
                &leave);
    bound_slabs(node[1] - p->origin.y, node[4] - p->origin.y, p->lowest.y, p->highest.y, entry,
                &leave);
    bound_slabs(node[2] - p->origin.z, node[5] - p->origin.z, p->lowest.z, p->highest.z, entry,
                &leave);
    return lanes_w(*entry <= leave);
}

// The rays that enter one child.
static uint enter_child(__global const float* lane, const Packet* p) {
    const float16 x0 = (lane[0] - p->origin.x) * p->ix;
    const float16 x1 = (lane[3 * BVH_WIDTH] - p->origin.x) * p->ix;
    const float16 y0 = (lane[BVH_WIDTH] - p->origin.y) * p->iy;
    const float16 y1 = (lane[4 * BVH_WIDTH] - p->origin.y) * p->iy;
    const float16 z0 = (lane[2 * BVH_WIDTH] - p->origin.z) * p->iz;
    const float16 z1 = (lane[5 * BVH_WIDTH] - p->origin.z) * p->iz;
    const float16 entry = max(max(min(x0, x1), min(y0, y1)), max(min(z0, z1), (float16)(0.0f)));
    const float16 leave = min(min(max(x0, x1), max(y0, y1)), min(max(z0, z1), p->end));
    return lanes_16(entry <= leave);
}

// The rays that hit triangle `lane` of a block.
static int16 hit_triangle(const PreparedBlock* b, uint lane, const Packet* p) {
    const float* values = (const float*)b;
#define ROW(i) values[(i)*BVH_BLOCK + lane]
    const float16 n = fma(p->x, ROW(0), fma(p->y, ROW(1), p->z * ROW(2)));
    const float16 q = fma(p->x, ROW(3), fma(p->y, ROW(4), p->z * ROW(5)));
    const float16 r = fma(p->x, ROW(6), fma(p->y, ROW(7), p->z * ROW(8)));
    const int16 sign = as_int16(n) & (int)0x80000000;
    const float16 determinant = fabs(n);
    const float16 u = as_float16(as_int16(q) ^ sign);
    const float16 v = as_float16(as_int16(r) ^ sign);
    const float16 t = as_float16(as_int(ROW(12)) ^ sign);
    const float16 s = fma(p->x, ROW(9), fma(p->y, ROW(10), p->z * ROW(11)));
    const float16 w = as_float16(as_int16(s) ^ sign);
    const float16 inside =
        min(min(fma(p->size, ROW(13), u), fma(p->size, ROW(14), v)), fma(p->size, ROW(15), w));
    return (inside >= 0.0f) & (determinant > ROW(16) * p->size) & (t > 0.0f) &
           (t < p->end * determinant);
#undef ROW
}

// t at which the rays meet the plane of triangle `lane`.
static float16 distance_to(const PreparedBlock* b, uint lane, const Packet* p) {
    const float* values = (const float*)b;
    const float16 n = fma(p->x, values[lane],
                          fma(p->y, values[BVH_BLOCK + lane], p->z * values[2 * BVH_BLOCK + lane]));
    return values[12 * BVH_BLOCK + lane] / n;
}

// Ends the rays that hit something, at -1; returns whether any did.
static bool occlude_packet(BVH_PARAMETERS, Packet* p) {
    int stack[BVH_STACK];
    uint masks[BVH_STACK];
    int top = 0;
    uint live = lanes_16(p->end > 0.0f);
    const uint all = live;
    stack[top] = 0;
    masks[top++] = live;
    while (top > 0) {
        const int entry = stack[--top];
        const uint mask = masks[top] & live;
        if (!mask) continue;
        const uint count = popcount(mask);
        if (entry < 0) {
            const PreparedBlock block =
                prepare_block(bvh_blocks + (~entry >> 4) * BLOCK_ROWS, p->origin);
            const uint triangles = (uint)(~entry & 15) + 1u;
            if (count < triangles) {
                for (uint rays = mask; rays; rays &= rays - 1u) {
                    const uint lane = lowest(rays);
                    if (!lanes_k(hit_block(&block, direction_of(p, lane), LANE(p->end, lane)).hit))
                        continue;
                    live &= ~(1u << lane);
                    SET_LANE(p->end, lane, -1.0f);
                }
            } else {
                for (uint triangle = 0u; triangle < triangles; ++triangle) {
                    const int16 hit = hit_triangle(&block, triangle, p);
                    const uint rays = lanes_16(hit);
                    if (!rays) continue;
                    live &= ~rays;
                    p->end = select(p->end, (float16)(-1.0f), hit);
                    if (!(mask & live)) break;
                }
            }
            if (!live) break;
            continue;
        }
        __global const float_w* node = bvh_nodes + entry * 7;
        __global const int* children = (__global const int*)(node + 6);
        float_w near;
        if (count <= PACKET_FEW) {
            int_w sets = (int_w)(0);
            for (uint rays = mask; rays; rays &= rays - 1u) {
                const uint lane = lowest(rays);
                const Prepared ray = prepared_of(p, lane);
                sets |= enter_children(node, &ray, LANE(p->end, lane), &near) & (int)(1u << lane);
            }
            for (uint lanes = lanes_w(sets != 0); lanes; lanes &= lanes - 1u) {
                const uint lane = lowest(lanes);
                stack[top] = children[lane];
                masks[top++] = ((const uint*)&sets)[lane];
            }
        } else {
            for (uint lanes = may_enter_children(node, p, &near); lanes; lanes &= lanes - 1u) {
                const uint lane = lowest(lanes);
                const uint entering = enter_child((__global const float*)node + lane, p) & mask;
                stack[top] = children[lane];
                masks[top] = entering;
                top += entering != 0u;
            }
        }
    }
    return live != all;
}

// Shortens every ray to its closest hit, whose triangle `triangles` gets; ~0 where there is none.
static void closest_hits(BVH_PARAMETERS, Packet* p, int16* triangles) {
    int stack[BVH_STACK];
    float distance[BVH_STACK];
    uint masks[BVH_STACK];
    int top = 0;
    *triangles = (int16)(~0);
    stack[top] = 0;
    distance[top] = 0.0f;
    masks[top++] = lanes_16(p->end > 0.0f);
    while (top > 0) {
        const int entry = stack[--top];
        if (distance[top] > p->furthest) continue;
        const uint mask = masks[top];
        const uint count = popcount(mask);
        if (entry < 0) {
            __global const float_k* rows = bvh_blocks + (~entry >> 4) * BLOCK_ROWS;
            __global const int* names = (__global const int*)(rows + 9);
            const PreparedBlock block = prepare_block(rows, p->origin);
            bool any_hit = false;
            const uint all = (uint)(~entry & 15) + 1u;
            if (count < all) {
                for (uint rays = mask; rays; rays &= rays - 1u) {
                    const uint lane = lowest(rays);
                    const BlockHits hits =
                        hit_block(&block, direction_of(p, lane), LANE(p->end, lane));
                    const uint found = lanes_k(hits.hit);
                    if (!found) continue;
                    const float_k t = hits.t / hits.n;
                    for (uint lanes = found; lanes; lanes &= lanes - 1u) {
                        const uint triangle = lowest(lanes);
                        if (LANE(t, triangle) >= LANE(p->end, lane)) continue;
                        SET_LANE(p->end, lane, LANE(t, triangle));
                        ((int*)triangles)[lane] = names[triangle];
                        any_hit = true;
                    }
                }
            } else {
                for (uint triangle = 0u; triangle < all; ++triangle) {
                    const int16 hit = hit_triangle(&block, triangle, p);
                    if (!lanes_16(hit)) continue;
                    p->end = select(p->end, distance_to(&block, triangle, p), hit);
                    *triangles = select(*triangles, (int16)(names[triangle]), hit);
                    any_hit = true;
                }
            }
            if (any_hit) p->furthest = highest_of(p->end);
            continue;
        }
        __global const float_w* node = bvh_nodes + entry * 7;
        __global const int* children = (__global const int*)(node + 6);
        float_w enter;
        int_w sets = (int_w)(0);
        uint lanes;
        if (count <= PACKET_FEW) {
            float_w nearest_entry = (float_w)(INFINITY);
            for (uint rays = mask; rays; rays &= rays - 1u) {
                const uint lane = lowest(rays);
                const Prepared ray = prepared_of(p, lane);
                const int_w entered = enter_children(node, &ray, LANE(p->end, lane), &enter);
                sets |= entered & (int)(1u << lane);
                nearest_entry = select(nearest_entry, min(nearest_entry, enter), entered);
            }
            enter = nearest_entry;
            lanes = lanes_w(sets != 0);
        } else {
            lanes = may_enter_children(node, p, &enter);
        }
        float nearest = INFINITY;
        for (; lanes; lanes &= lanes - 1u) {  // the nearest child ends on top of the stack
            const uint lane = lowest(lanes);
            const uint entering = count <= PACKET_FEW
                                      ? ((const uint*)&sets)[lane]
                                      : enter_child((__global const float*)node + lane, p) & mask;
            if (!entering) continue;
            int place = top++;
            if (LANE(enter, lane) >= nearest) {
                stack[place] = stack[place - 1];
                distance[place] = distance[place - 1];
                masks[place] = masks[place - 1];
                --place;
            } else {
                nearest = LANE(enter, lane);
            }
            stack[place] = children[lane];
            distance[place] = LANE(enter, lane);
            masks[place] = entering;
        }
    }
}

#endif

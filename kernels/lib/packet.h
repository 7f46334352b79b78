// SPDX-License-Identifier: MIT
// LANES rays with one origin against the wide BVH of lib/bvh.h, by one work-item. Sets of rays are
// integers, 1 << lane.
#ifndef MANYLIGHT_LIB_PACKET_H
#define MANYLIGHT_LIB_PACKET_H

#include "lib/bvh.h"

#if LANES > 1

// So many rays, or fewer, are tested one by one against all of a node's children at once, instead
// of all at once against one child after another.
#define PACKET_FEW (LANES / 2)

// Segments origin + t direction, 0 < t < end; a lane whose end is not positive holds no ray.
typedef struct Packet {
    float3 origin;
    float_n x, y, z;                 // directions
    float_n size;                    // their largest parts
    float_n ix, iy, iz, bx, by, bz;  // slabs: planes at q are crossed at q * i + b
    int_n near_x, near_y, near_z;    // as in Prepared
    float_n end;
    float3 lowest, highest;  // bounds of the inverses (ix, iy, iz) over all rays
    float furthest;          // the last end
} Packet;

static float_n safe_inverse_n(float_n d) {
    return 1.0f / select(d, copysign((float_n)(1e-20f), d), fabs(d) < 1e-20f);
}

static float highest_of(float_n v) { return -lowest_of(-v); }

static Packet make_packet(float3 origin, float_n x, float_n y, float_n z, float_n end) {
    Packet p;
    p.origin = origin;
    p.x = x;
    p.y = y;
    p.z = z;
    p.end = end;
    p.ix = safe_inverse_n(x);
    p.iy = safe_inverse_n(y);
    p.iz = safe_inverse_n(z);
    p.bx = -origin.x * p.ix;
    p.by = -origin.y * p.iy;
    p.bz = -origin.z * p.iz;
    p.near_x = select((int_n)(0), (int_n)(3), p.ix < 0.0f);
    p.near_y = select((int_n)(1), (int_n)(4), p.iy < 0.0f);
    p.near_z = select((int_n)(2), (int_n)(5), p.iz < 0.0f);
    p.size = max(max(fabs(x), fabs(y)), fabs(z));
    const int_n none = !(end > 0.0f);
    const float_n far = (float_n)(INFINITY);
    p.lowest = (float3)(lowest_of(select(p.ix, far, none)), lowest_of(select(p.iy, far, none)),
                        lowest_of(select(p.iz, far, none)));
    p.highest = (float3)(highest_of(select(p.ix, -far, none)), highest_of(select(p.iy, -far, none)),
                         highest_of(select(p.iz, -far, none)));
    p.furthest = highest_of(end);
    return p;
}

static float3 direction_of(const Packet* p, uint lane) {
    return (float3)(LANE(p->x, lane), LANE(p->y, lane), LANE(p->z, lane));
}

static Prepared prepared_of(const Packet* p, uint lane) {
    Prepared r;
    r.inverse = (float3)(LANE(p->ix, lane), LANE(p->iy, lane), LANE(p->iz, lane));
    r.bias = (float3)(LANE(p->bx, lane), LANE(p->by, lane), LANE(p->bz, lane));
    r.near_x = INT_LANE(p->near_x, lane);
    r.near_y = INT_LANE(p->near_y, lane);
    r.near_z = INT_LANE(p->near_z, lane);
    return r;
}

// Where any ray may enter and leave the slabs of an axis, given bounds of the inverses: planes are
// relative to the origin. Nothing can be said where directions differ in sign.
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
    return lanes_w((*entry <= leave) & (node[0] <= node[3]));  // which empty lanes are not
}

// The rays that enter one child.
static uint enter_child(__global const float* lane, const Packet* p) {
    const float_n lx = (float_n)(lane[0]), hx = (float_n)(lane[3 * BVH_WIDTH]);
    const float_n ly = (float_n)(lane[BVH_WIDTH]), hy = (float_n)(lane[4 * BVH_WIDTH]);
    const float_n lz = (float_n)(lane[2 * BVH_WIDTH]), hz = (float_n)(lane[5 * BVH_WIDTH]);
    const float_n x0 = fma(lx, p->ix, p->bx), x1 = fma(hx, p->ix, p->bx);
    const float_n y0 = fma(ly, p->iy, p->by), y1 = fma(hy, p->iy, p->by);
    const float_n z0 = fma(lz, p->iz, p->bz), z1 = fma(hz, p->iz, p->bz);
    const float_n entry = max(max(min(x0, x1), min(y0, y1)), max(min(z0, z1), (float_n)(0.0f)));
    const float_n leave = min(min(max(x0, x1), max(y0, y1)), min(max(z0, z1), p->end));
    return lanes_n(entry <= leave);
}

// A triangle of a block as all rays meet it.
typedef struct TriangleHits {
    float_n t, n;  // t and what it is to be divided by
    int_n hit;
} TriangleHits;

// hit_block() the other way round: all rays against triangle `lane` of a block.
static TriangleHits hit_triangle(const PreparedBlock* b, uint lane, const Packet* p) {
#define DOT(v) \
    fma(p->x, LANE((v)[0], lane), fma(p->y, LANE((v)[1], lane), p->z* LANE((v)[2], lane)))
#define WITH_MARGIN(margin, v) fma(p->size, LANE(margin, lane), as_float_n(as_int_n(DOT(v)) ^ sign))
    TriangleHits hits;
    const float_n n = DOT(b->n);
    const int_n sign = as_int_n(n) & (int)0x80000000;
    const float_n inside = min(min(WITH_MARGIN(b->margin_u, b->q), WITH_MARGIN(b->margin_v, b->r)),
                               WITH_MARGIN(b->margin_w, b->s));
    hits.n = fabs(n);
    hits.t = as_float_n(as_int(LANE(b->t, lane)) ^ sign);
    hits.hit = (inside >= 0.0f) & (hits.n > LANE(b->least_n, lane) * p->size) & (hits.t > 0.0f) &
               (hits.t < p->end * hits.n);
    return hits;
#undef WITH_MARGIN
#undef DOT
}

// The children that rays of a set enter: `sets` gets which rays, `entry` where the first does, at
// the earliest.
static uint enter_children_n(__global const float_w* node, const Packet* p, uint rays, int_w* sets,
                             float_w* entry) {
    uint entered = 0u;
    if (popcount(rays) <= PACKET_FEW) {
        *entry = (float_w)(INFINITY);
        *sets = (int_w)(0);
        for (; rays; rays &= rays - 1u) {
            const uint lane = lowest(rays);
            const Prepared ray = prepared_of(p, lane);
            float_w near;
            const int_w hit = enter_children(node, &ray, LANE(p->end, lane), &near);
            *sets |= hit & (int)(1u << lane);
            *entry = select(*entry, min(*entry, near), hit);
        }
        entered = lanes_w(*sets != 0);
    } else {
        for (uint lanes = may_enter_children(node, p, entry); lanes; lanes &= lanes - 1u) {
            const uint lane = lowest(lanes);
            const uint hit = enter_child((__global const float*)node + lane, p) & rays;
            INT_LANE(*sets, lane) = (int)hit;
            entered |= (uint)(hit != 0u) << lane;
        }
    }
    return entered;
}

#if HAS_ALPHA
// Whether a triangle of a block is there for one of the rays.
static bool is_there_for(const Packet* p, uint ray, const PreparedBlock* b, uint lane,
                         uint triangle, uint seen ALPHA_PARAMETERS) {
    return is_block_there(b, lane, p->origin, direction_of(p, ray), triangle, seen ALPHA_ARGUMENTS);
}

// Of the rays that hit it, those that it is there for.
static int_n there_for_all(const Packet* p, int_n hit, const PreparedBlock* b, uint lane,
                           uint triangle, uint seen ALPHA_PARAMETERS) {
    if (alpha_of[triangle] == NO_ALPHA) return hit;
    for (uint rays = lanes_n(hit); rays; rays &= rays - 1u) {
        const uint ray = lowest(rays);
        if (!is_there_for(p, ray, b, lane, triangle, seen ALPHA_ARGUMENTS)) INT_LANE(hit, ray) = 0;
    }
    return hit;
}
#endif

#if HAS_INSTANCES
// The packet in the frame of an instance.
static Packet packet_in_instance(const Packet* p, __global const Instance* in) {
    const float4 a = in->to_object[0], b = in->to_object[1], c = in->to_object[2];
    return make_packet(point_to_object(in, p->origin), fma(a.x, p->x, fma(a.y, p->y, a.z * p->z)),
                       fma(b.x, p->x, fma(b.y, p->y, b.z * p->z)),
                       fma(c.x, p->x, fma(c.y, p->y, c.z * p->z)), p->end);
}

static void leave_instance(const Packet* inside, Packet* world) {
    world->end = inside->end;
    world->furthest = inside->furthest;
}
#endif

// Ends the rays that hit something, at -1; returns whether any did.
static bool occlude_packet(BVH_PARAMETERS, Packet* p) {
    int stack[BVH_STACK];
    uint masks[BVH_STACK];
    int top = 0;
    uint live = lanes_n(p->end > 0.0f);
    const uint all = live;
    stack[top] = 0;
    masks[top++] = live;
#if HAS_INSTANCES
    Packet inside;  // an instance; then p points to it
    Packet* const world = p;
    int outside = 0;     // as in occluded()
    uint renumber = 0u;  // to be added to the indices of triangles
#elif HAS_ALPHA
    const uint renumber = 0u;
#endif
    while (top > 0) {
#if HAS_INSTANCES
        if (top == outside) {
            leave_instance(p, world);
            p = world;
            outside = 0;
            renumber = 0u;
        }
#endif
        const int entry = stack[--top];
        const uint mask = masks[top] & live;
        if (!mask) continue;
#if HAS_INSTANCES
        if (entry >= INSTANCE_CHILD) {
            __global const Instance* in = bvh_instances + (entry - INSTANCE_CHILD);
            inside = packet_in_instance(world, in);
            p = &inside;
            outside = top;
            renumber = in->first - in->stored;
            stack[top++] = in->root;  // for the same rays
            continue;
        }
#endif
        if (entry < 0) {
            __global const float_k* rows = bvh_blocks + (~entry >> 4) * BLOCK_ROWS;
            const PreparedBlock block = prepare_block(rows, p->origin);
#if HAS_ALPHA
            __global const uint* names = (__global const uint*)(rows + 9);
#endif
            const uint triangles = (uint)(~entry & 15) + 1u;
            if (popcount(mask) < triangles) {
                for (uint rays = mask; rays; rays &= rays - 1u) {
                    const uint lane = lowest(rays);
                    uint found = lanes_k(hit_block(&block, direction_of(p, lane),
                                                   LANE(p->size, lane), LANE(p->end, lane))
                                             .hit);
#if HAS_ALPHA
                    for (; found; found &= found - 1u) {
                        const uint t = lowest(found);
                        if (is_there_for(p, lane, &block, t, names[t],
                                         names[t] + renumber ALPHA_ARGUMENTS))
                            break;
                    }
#endif
                    if (!found) continue;
                    live &= ~(1u << lane);
                    SET_LANE(p->end, lane, -1.0f);
                }
            } else {
                for (uint triangle = 0u; triangle < triangles; ++triangle) {
                    int_n hit = hit_triangle(&block, triangle, p).hit;
#if HAS_ALPHA
                    hit = there_for_all(p, hit, &block, triangle, names[triangle],
                                        names[triangle] + renumber ALPHA_ARGUMENTS);
#endif
                    const uint rays = lanes_n(hit);
                    if (!rays) continue;
                    live &= ~rays;
                    p->end = select(p->end, (float_n)(-1.0f), hit);
                    if (!(mask & live)) break;
                }
            }
            if (!live) break;
            continue;
        }
        __global const float_w* node = bvh_nodes + entry * 7;
        __global const int* children = (__global const int*)(node + 6);
        int_w sets;
        float_w near;
        for (uint lanes = enter_children_n(node, p, mask, &sets, &near); lanes;
             lanes &= lanes - 1u) {
            const uint lane = lowest(lanes);
            stack[top] = children[lane];
            masks[top++] = (uint)INT_LANE(sets, lane);
        }
    }
#if HAS_INSTANCES
    leave_instance(p, world);
#endif
    return live != all;
}

// Shortens every ray to its closest hit, whose triangle `triangles` gets; ~0 where there is none.
static void closest_hits(BVH_PARAMETERS, Packet* p, int_n* triangles) {
    int stack[BVH_STACK];
    float distance[BVH_STACK];
    uint masks[BVH_STACK];
    int top = 0;
    *triangles = (int_n)(~0);
    stack[top] = 0;
    distance[top] = 0.0f;
    masks[top++] = lanes_n(p->end > 0.0f);
#if HAS_INSTANCES
    Packet inside;  // as in occlude_packet()
    Packet* const world = p;
    int outside = 0;
    int renumber = 0;  // to be added to the indices of triangles
#else
    const int renumber = 0;
#endif
    while (top > 0) {
#if HAS_INSTANCES
        if (top == outside) {
            leave_instance(p, world);
            p = world;
            outside = 0;
            renumber = 0;
        }
#endif
        const int entry = stack[--top];
        if (distance[top] > p->furthest) continue;
        const uint mask = masks[top];
#if HAS_INSTANCES
        if (entry >= INSTANCE_CHILD) {
            __global const Instance* in = bvh_instances + (entry - INSTANCE_CHILD);
            inside = packet_in_instance(world, in);
            p = &inside;
            outside = top;
            renumber = (int)(in->first - in->stored);
            stack[top++] = in->root;  // for the same rays, at the same distance
            continue;
        }
#endif
        if (entry < 0) {
            __global const float_k* rows = bvh_blocks + (~entry >> 4) * BLOCK_ROWS;
            __global const int* names = (__global const int*)(rows + 9);
            const PreparedBlock block = prepare_block(rows, p->origin);
            bool any_hit = false;
            const uint all = (uint)(~entry & 15) + 1u;
            if (popcount(mask) < all) {
                for (uint rays = mask; rays; rays &= rays - 1u) {
                    const uint lane = lowest(rays);
                    const BlockHits hits = hit_block(&block, direction_of(p, lane),
                                                     LANE(p->size, lane), LANE(p->end, lane));
                    const uint found = lanes_k(hits.hit);
                    if (!found) continue;
                    const float_k t = hits.t / hits.n;
                    for (uint lanes = found; lanes; lanes &= lanes - 1u) {
                        const uint triangle = lowest(lanes);
                        if (LANE(t, triangle) >= LANE(p->end, lane)) continue;
#if HAS_ALPHA
                        if (!is_there_for(p, lane, &block, triangle, (uint)names[triangle],
                                          (uint)(names[triangle] + renumber) ALPHA_ARGUMENTS))
                            continue;
#endif
                        SET_LANE(p->end, lane, LANE(t, triangle));
                        INT_LANE(*triangles, lane) = names[triangle] + renumber;
                        any_hit = true;
                    }
                }
            } else {
                for (uint triangle = 0u; triangle < all; ++triangle) {
                    TriangleHits hits = hit_triangle(&block, triangle, p);
#if HAS_ALPHA
                    hits.hit = there_for_all(p, hits.hit, &block, triangle, (uint)names[triangle],
                                             (uint)(names[triangle] + renumber) ALPHA_ARGUMENTS);
#endif
                    if (!lanes_n(hits.hit)) continue;
                    p->end = select(p->end, hits.t / hits.n, hits.hit);
                    *triangles = select(*triangles, (int_n)(names[triangle] + renumber), hits.hit);
                    any_hit = true;
                }
            }
            if (any_hit) p->furthest = highest_of(p->end);
            continue;
        }
        __global const float_w* node = bvh_nodes + entry * 7;
        __global const int* children = (__global const int*)(node + 6);
        int_w sets;
        float_w enter;
        uint lanes = enter_children_n(node, p, mask, &sets, &enter);
        float nearest = INFINITY;
        for (; lanes; lanes &= lanes - 1u) {  // the nearest child ends on top of the stack
            const uint lane = lowest(lanes);
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
            masks[place] = (uint)INT_LANE(sets, lane);
        }
    }
#if HAS_INSTANCES
    leave_instance(p, world);
#endif
}

#endif

#endif

// SPDX-License-Identifier: MIT
// 16 rays with one origin, in vectors of LANES rays, the packet's parts, against the boxes and
// triangles of lib/bvh.h. Sets of rays are integers, 1 << ray.
#ifndef MANYLIGHT_LIB_PACKET_H
#define MANYLIGHT_LIB_PACKET_H

#include "lib/bvh.h"

#if LANES > 1

#define PARTS (16 / LANES)

// So many rays, or fewer, are tested one by one against all of a node's children at once, instead
// of all at once against one child after another.
#ifndef PACKET_FEW
#define PACKET_FEW 8
#endif

// Segments origin + t direction, 0 < t < end; a ray whose end is not positive does not exist.
typedef struct Packet {
    float3 origin;
    float_n x[PARTS], y[PARTS], z[PARTS];  // directions
    float_n end[PARTS];
    float_n size[PARTS];                      // the directions' largest parts
    float_n ix[PARTS], iy[PARTS], iz[PARTS];  // slabs: planes at q are crossed at q * i + b
    float_n bx[PARTS], by[PARTS], bz[PARTS];
    int_n near_x[PARTS], near_y[PARTS], near_z[PARTS];  // as in Prepared
    float3 lowest, highest;                             // bounds of the inverses (ix, iy, iz)
    float furthest;                                     // the last end
    uint renumber;                                      // to be added to the indices of triangles
} Packet;

INLINE float_n safe_inverse_n(float_n d) {
    return 1.0f / select(d, copysign((float_n)(1e-20f), d), fabs(d) < 1e-20f);
}

INLINE float highest_of(float_n v) { return -lowest_of(-v); }

static float last_end(const Packet* p) {
    float_n last = p->end[0];
    for (uint i = 1u; i < PARTS; ++i) last = max(last, p->end[i]);
    return highest_of(last);
}

// Completes a packet of the world that has an origin, directions and ends.
static void prepare_packet(Packet* p) {
    p->renumber = 0u;
    const float_n far = (float_n)(INFINITY);
    float_n low_x = far, low_y = far, low_z = far, high_x = -far, high_y = -far, high_z = -far;
    for (uint i = 0u; i < PARTS; ++i) {
        const float_n ix = safe_inverse_n(p->x[i]), iy = safe_inverse_n(p->y[i]),
                      iz = safe_inverse_n(p->z[i]);
        p->ix[i] = ix;
        p->iy[i] = iy;
        p->iz[i] = iz;
        p->bx[i] = -p->origin.x * ix;
        p->by[i] = -p->origin.y * iy;
        p->bz[i] = -p->origin.z * iz;
        p->near_x[i] = select((int_n)(0), (int_n)(3), ix < 0.0f);
        p->near_y[i] = select((int_n)(1), (int_n)(4), iy < 0.0f);
        p->near_z[i] = select((int_n)(2), (int_n)(5), iz < 0.0f);
        p->size[i] = max(max(fabs(p->x[i]), fabs(p->y[i])), fabs(p->z[i]));
        const int_n none = !(p->end[i] > 0.0f);
        low_x = min(low_x, select(ix, far, none));
        low_y = min(low_y, select(iy, far, none));
        low_z = min(low_z, select(iz, far, none));
        high_x = max(high_x, select(ix, -far, none));
        high_y = max(high_y, select(iy, -far, none));
        high_z = max(high_z, select(iz, -far, none));
    }
    p->lowest = (float3)(lowest_of(low_x), lowest_of(low_y), lowest_of(low_z));
    p->highest = (float3)(highest_of(high_x), highest_of(high_y), highest_of(high_z));
    p->furthest = last_end(p);
}

// The rays that exist.
static uint rays_of(const Packet* p) {
    uint rays = 0u;
    for (uint i = 0u; i < PARTS; ++i) rays |= lanes_n(p->end[i] > 0.0f) << (LANES * i);
    return rays;
}

// Those of a set in one part.
#define PART_OF(rays, part) ((rays) >> (LANES * (part)) & ALL_LANES)

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

// The rays of a set that enter one child.
static uint enter_child(__global const float* lane, const Packet* p, uint rays) {
    uint entered = 0u;
    for (uint i = 0u; i < PARTS; ++i) {
        if (PARTS > 1 && !PART_OF(rays, i)) continue;
        const float_n x0 = fma((float_n)(lane[0]), p->ix[i], p->bx[i]);
        const float_n x1 = fma((float_n)(lane[3 * BVH_WIDTH]), p->ix[i], p->bx[i]);
        const float_n y0 = fma((float_n)(lane[BVH_WIDTH]), p->iy[i], p->by[i]);
        const float_n y1 = fma((float_n)(lane[4 * BVH_WIDTH]), p->iy[i], p->by[i]);
        const float_n z0 = fma((float_n)(lane[2 * BVH_WIDTH]), p->iz[i], p->bz[i]);
        const float_n z1 = fma((float_n)(lane[5 * BVH_WIDTH]), p->iz[i], p->bz[i]);
        const float_n entry = max(max(min(x0, x1), min(y0, y1)), max(min(z0, z1), (float_n)(0.0f)));
        const float_n leave = min(min(max(x0, x1), max(y0, y1)), min(max(z0, z1), p->end[i]));
        entered |= lanes_n(entry <= leave) << (LANES * i);
    }
    return entered & rays;
}

// A triangle of a block as the rays of a part meet it.
typedef struct TriangleHits {
    float_n t, n;  // t and what it is to be divided by
    int_n hit;
} TriangleHits;

// hit_block() the other way round: a part's rays against triangle `lane` of a block.
INLINE TriangleHits hit_triangle(const PreparedBlock* b, uint lane, const Packet* p, uint part,
                                 const bool occlude) {
    const float_n x = p->x[part], y = p->y[part], z = p->z[part], size = p->size[part];
#define DOT(v) fma(x, LANE((v)[0], lane), fma(y, LANE((v)[1], lane), z* LANE((v)[2], lane)))
#define WITH_MARGIN(margin, v) fma(size, LANE(margin, lane), as_float_n(as_int_n(DOT(v)) ^ sign))
    TriangleHits hits;
    const float_n n = DOT(b->n);
    const int_n sign = as_int_n(n) & (int)0x80000000;
    const float_n inside = min(min(WITH_MARGIN(b->margin_u, b->q), WITH_MARGIN(b->margin_v, b->r)),
                               WITH_MARGIN(b->margin_w, b->s));
    hits.n = fabs(n);
    hits.t = as_float_n(as_int(occlude ? LANE(b->most_t, lane) : LANE(b->t, lane)) ^ sign);
    hits.hit = (inside >= 0.0f) & (hits.t > 0.0f);
    if (occlude)
        hits.hit &= hits.t < fma(size, (float_n)(-LANE(b->surplus_n, lane)), hits.n) * p->end[part];
    else
        hits.hit &= (hits.n > LANE(b->least_n, lane) * size) & (hits.t < p->end[part] * hits.n);
    return hits;
#undef WITH_MARGIN
#undef DOT
}

// The children that rays of a set enter: `sets` gets which rays, `entry` where the first does, at
// the earliest.
static uint enter_children_of(__global const float_w* node, const Packet* p, uint rays, int_w* sets,
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
            const uint hit = enter_child((__global const float*)node + lane, p, rays);
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

// Of a part's rays that hit it, those that it is there for.
INLINE int_n there_for_all(const Packet* p, uint part, int_n hit, const PreparedBlock* b, uint lane,
                           uint triangle, uint seen ALPHA_PARAMETERS) {
    if (alpha_of[triangle] == NO_ALPHA) return hit;
    for (uint rays = lanes_n(hit); rays; rays &= rays - 1u) {
        const uint ray = lowest(rays);
        if (!is_there_for(p, LANES * part + ray, b, lane, triangle, seen ALPHA_ARGUMENTS))
            INT_LANE(hit, ray) = 0;
    }
    return hit;
}
#endif

#if HAS_INSTANCES
// The packet in the frame of an instance.
static Packet packet_in_instance(const Packet* p, __global const Instance* in) {
    const float4 a = in->to_object[0], b = in->to_object[1], c = in->to_object[2];
    Packet inside;
    inside.origin = point_to_object(in, p->origin);
    for (uint i = 0u; i < PARTS; ++i) {
        const float_n x = p->x[i], y = p->y[i], z = p->z[i];
        inside.x[i] = fma(a.x, x, fma(a.y, y, a.z * z));
        inside.y[i] = fma(b.x, x, fma(b.y, y, b.z * z));
        inside.z[i] = fma(c.x, x, fma(c.y, y, c.z * z));
        inside.end[i] = p->end[i];
    }
    prepare_packet(&inside);
    inside.renumber = in->first - in->stored;
    return inside;
}

static void leave_instance(const Packet* inside, Packet* world) {
    for (uint i = 0u; i < PARTS; ++i) world->end[i] = inside->end[i];
    world->furthest = inside->furthest;
}
#endif

#endif

#endif

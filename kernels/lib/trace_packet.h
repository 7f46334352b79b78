// SPDX-License-Identifier: MIT
// A packet of lib/packet.h against the wide BVH of lib/bvh.h, by one work-item.
#ifndef MANYLIGHT_LIB_TRACE_PACKET_H
#define MANYLIGHT_LIB_TRACE_PACKET_H

#include "lib/packet.h"

#if LANES > 1

// Ends the rays that hit a leaf's triangles, at -1, those of a set and maybe others; returns which.
static uint occlude_in_leaf(__global const float_k* bvh_blocks, int entry, Packet* p,
                            uint mask ALPHA_PARAMETERS) {
    uint ended = 0u;
    __global const float_k* rows = bvh_blocks + (~entry >> 4) * BLOCK_ROWS;
    const PreparedBlock block = prepare_block(rows, p->origin);
#if HAS_ALPHA
    __global const uint* names = (__global const uint*)(rows + 9);
#endif
    const uint triangles = (uint)(~entry & 15) + 1u;
    if (popcount(mask) < PARTS * triangles) {
        for (uint rays = mask; rays; rays &= rays - 1u) {
            const uint lane = lowest(rays);
            uint found = lanes_k(hit_block(&block, direction_of(p, lane), LANE(p->size, lane),
                                           LANE(p->end, lane), true)
                                     .hit);
#if HAS_ALPHA
            for (; found; found &= found - 1u) {
                const uint t = lowest(found);
                if (is_there_for(p, lane, &block, t, names[t],
                                 names[t] + p->renumber ALPHA_ARGUMENTS))
                    break;
            }
#endif
            if (!found) continue;
            ended |= 1u << lane;
            SET_LANE(p->end, lane, -1.0f);
        }
    } else {
        for (uint triangle = 0u; triangle < triangles && (mask & ~ended); ++triangle)
            for (uint part = 0u; part < PARTS; ++part) {
                if (PARTS > 1 && !PART_OF(mask & ~ended, part)) continue;
                int_n hit = hit_triangle(&block, triangle, p, part, true).hit;
#if HAS_ALPHA
                hit = there_for_all(p, part, hit, &block, triangle, names[triangle],
                                    names[triangle] + p->renumber ALPHA_ARGUMENTS);
#endif
                const uint rays = lanes_n(hit);
                if (!rays) continue;
                ended |= rays << (LANES * part);
                p->end[part] = select(p->end[part], (float_n)(-1.0f), hit);
            }
    }
    return ended;
}

// Ends the rays that hit something, at -1; returns whether any did.
static bool occlude_packet(BVH_PARAMETERS, Packet* p) {
    int stack[BVH_STACK];
    uint masks[BVH_STACK];
    int top = 0;
    uint live = rays_of(p);
    const uint all = live;
    stack[top] = 0;
    masks[top++] = live;
#if HAS_INSTANCES
    Packet inside;  // an instance; then p points to it
    Packet* const world = p;
    int outside = 0;  // as in occluded()
#endif
    while (top > 0) {
#if HAS_INSTANCES
        if (top == outside) {
            leave_instance(p, world);
            p = world;
            outside = 0;
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
            stack[top++] = in->root;  // for the same rays
            continue;
        }
#endif
        if (entry < 0) {
            live &= ~occlude_in_leaf(bvh_blocks, entry, p, mask ALPHA_ARGUMENTS);
            if (!live) break;
            continue;
        }
        __global const float_w* node = bvh_nodes + entry * 7;
        __global const int* children = (__global const int*)(node + 6);
        int_w sets;
        float_w near;
        for (uint lanes = enter_children_of(node, p, mask, &sets, &near); lanes;
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

// Shortens the rays of a set to their closest hits among a leaf's triangles, as closest_hits()
// does.
static void hit_leaf(__global const float_k* bvh_blocks, int entry, Packet* p, uint mask,
                     const float_n* starts, int_n* triangles ALPHA_PARAMETERS) {
    __global const float_k* rows = bvh_blocks + (~entry >> 4) * BLOCK_ROWS;
    __global const uint* names = (__global const uint*)(rows + 9);
    const PreparedBlock block = prepare_block(rows, p->origin);
    bool any_hit = false;
    const uint all = (uint)(~entry & 15) + 1u;
    if (popcount(mask) < PARTS * all) {
        for (uint rays = mask; rays; rays &= rays - 1u) {
            const uint lane = lowest(rays);
            const BlockHits hits = hit_block(&block, direction_of(p, lane), LANE(p->size, lane),
                                             LANE(p->end, lane), false);
            const uint found = lanes_k(hits.hit);
            if (!found) continue;
            const float_k t = hits.t / hits.n;
            for (uint lanes = found; lanes; lanes &= lanes - 1u) {
                const uint triangle = lowest(lanes);
                if (LANE(t, triangle) >= LANE(p->end, lane) ||
                    LANE(t, triangle) <= ((const float*)starts)[lane])
                    continue;
#if HAS_ALPHA
                if (!is_there_for(p, lane, &block, triangle, names[triangle],
                                  names[triangle] + p->renumber ALPHA_ARGUMENTS))
                    continue;
#endif
                SET_LANE(p->end, lane, LANE(t, triangle));
                ((int*)triangles)[lane] = (int)(names[triangle] + p->renumber);
                any_hit = true;
            }
        }
    } else {
        for (uint triangle = 0u; triangle < all; ++triangle)
            for (uint part = 0u; part < PARTS; ++part) {
                if (PARTS > 1 && !PART_OF(mask, part)) continue;
                TriangleHits hits = hit_triangle(&block, triangle, p, part, false);
                hits.hit &= hits.t > starts[part] * hits.n;
#if HAS_ALPHA
                hits.hit = there_for_all(p, part, hits.hit, &block, triangle, names[triangle],
                                         names[triangle] + p->renumber ALPHA_ARGUMENTS);
#endif
                if (!lanes_n(hits.hit)) continue;
                p->end[part] = select(p->end[part], hits.t / hits.n, hits.hit);
                triangles[part] = select(triangles[part],
                                         (int_n)((int)(names[triangle] + p->renumber)), hits.hit);
                any_hit = true;
            }
    }
    if (any_hit) p->furthest = last_end(p);
}

// Shortens every ray to its closest hit beyond `starts`, whose triangle `triangles` gets; ~0 where
// there is none.
INLINE void closest_hits(BVH_PARAMETERS, Packet* p, const float_n* starts, int_n* triangles) {
    int stack[BVH_STACK];
    float distance[BVH_STACK];
    uint masks[BVH_STACK];
    int top = 0;
    for (uint i = 0u; i < PARTS; ++i) triangles[i] = (int_n)(~0);
    stack[top] = 0;
    distance[top] = 0.0f;
    masks[top++] = rays_of(p);
#if HAS_INSTANCES
    Packet inside;  // as in occlude_packet()
    Packet* const world = p;
    int outside = 0;
#endif
    while (top > 0) {
#if HAS_INSTANCES
        if (top == outside) {
            leave_instance(p, world);
            p = world;
            outside = 0;
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
            stack[top++] = in->root;  // for the same rays, at the same distance
            continue;
        }
#endif
        if (entry < 0) {
            hit_leaf(bvh_blocks, entry, p, mask, starts, triangles ALPHA_ARGUMENTS);
            continue;
        }
        __global const float_w* node = bvh_nodes + entry * 7;
        __global const int* children = (__global const int*)(node + 6);
        int_w sets;
        float_w enter;
        uint lanes = enter_children_of(node, p, mask, &sets, &enter);
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

// SPDX-License-Identifier: MIT
// Ray against wide BVH, one ray per work-item, all children or triangles of a node at once.
//
// Layout (host/bvh/wide.hpp): a node is 7 vectors of BVH_WIDTH lanes: lower x y z, upper x y z,
// children. A child >= 0 is a node or, from INSTANCE_CHILD on, an instance; < 0 is a leaf of
// lib/block.h, ~(block << 4 | triangles - 1); empty lanes have inverted bounds and child -1.
#ifndef MANYLIGHT_LIB_BVH_H
#define MANYLIGHT_LIB_BVH_H

#include "lib/alpha.h"
#include "lib/block.h"
#include "lib/common.h"
#include "lib/instances.h"
#include "lib/lanes.h"

typedef JOIN(float, BVH_WIDTH) float_w;
typedef JOIN(int, BVH_WIDTH) int_w;

#define lanes_w JOIN(lanes_, BVH_WIDTH)

// A segment origin + t direction, 0 < t < end.
typedef struct Ray {
    float3 origin;
    float3 direction;
    float end;
} Ray;

// Triangle ~0u: none.
typedef struct Hit {
    uint triangle;
    float t;
} Hit;

#define BVH_PARAMETERS                 \
    __global const float_w *bvh_nodes, \
        __global const float_k *bvh_blocks INSTANCE_PARAMETERS ALPHA_PARAMETERS
#define BVH_ARGUMENTS bvh_nodes, bvh_blocks INSTANCE_ARGUMENTS ALPHA_ARGUMENTS

// What the test of boxes needs of a ray.
typedef struct Prepared {
    float3 inverse;  // slabs: planes at p are crossed at p * inverse + bias
    float3 bias;
    int near_x, near_y, near_z;  // which of a node's vectors holds the plane that is met first
} Prepared;

static float safe_inverse(float d) {
    // Far below any direction that matters; its inverse times any coordinate stays finite.
    return 1.0f / (fabs(d) < 1e-20f ? copysign(1e-20f, d) : d);
}

static Prepared prepare(float3 origin, float3 inverse) {
    Prepared p;
    p.inverse = inverse;
    p.bias = -origin * inverse;
    p.near_x = inverse.x < 0.0f ? 3 : 0;
    p.near_y = inverse.y < 0.0f ? 4 : 1;
    p.near_z = inverse.z < 0.0f ? 5 : 2;
    return p;
}

static Prepared prepare_ray(Ray ray) {
    const float3 d = ray.direction;
    return prepare(ray.origin, (float3)(safe_inverse(d.x), safe_inverse(d.y), safe_inverse(d.z)));
}

// The children whose boxes the segment enters; `entry` gets where. Boxes are padded on the host by
// more than the rounding error of these operations (host/bvh/wide.hpp).
static int_w enter_children(__global const float_w* node, const Prepared* s, float end,
                            float_w* entry) {
    const float_w ix = s->inverse.x, iy = s->inverse.y, iz = s->inverse.z;
    const float_w bx = s->bias.x, by = s->bias.y, bz = s->bias.z;
    const float_w near_x = fma(node[s->near_x], ix, bx);
    const float_w near_y = fma(node[s->near_y], iy, by);
    const float_w near_z = fma(node[s->near_z], iz, bz);
    const float_w far_x = fma(node[3 - s->near_x], ix, bx);
    const float_w far_y = fma(node[5 - s->near_y], iy, by);
    const float_w far_z = fma(node[7 - s->near_z], iz, bz);
    *entry = max(max(near_x, near_y), max(near_z, (float_w)(0.0f)));
    const float_w leave = min(min(far_x, far_y), min(far_z, (float_w)(end)));
    return *entry <= leave;
}

static float largest_part(float3 v) { return max(max(fabs(v.x), fabs(v.y)), fabs(v.z)); }

// A ray in the frame in which it is traced: the world's or an instance's. Its t is the same.
typedef struct Traced {
    Ray ray;
    Prepared prepared;
    float size;     // the largest part of the direction
    uint renumber;  // to be added to the indices of triangles
} Traced;

static Traced trace_in_world(Ray ray) {
    const Traced traced = {ray, prepare_ray(ray), largest_part(ray.direction), 0u};
    return traced;
}

#if HAS_INSTANCES
static Traced trace_in_instance(Ray ray, __global const Instance* in) {
    ray.origin = point_to_object(in, ray.origin);
    ray.direction = direction_to_object(in, ray.direction);
    Traced traced = trace_in_world(ray);
    traced.renumber = in->first - in->stored;
    return traced;
}
#endif

// Whether anything is hit within the segment.
static bool occluded(BVH_PARAMETERS, Ray ray) {
    Traced traced = trace_in_world(ray);
    int stack[BVH_STACK];
    int top = 0;
    stack[top++] = 0;
#if HAS_INSTANCES
    int outside = 0;  // at this height of the stack, the ray is back in the world
#endif
    while (top > 0) {
#if HAS_INSTANCES
        if (top == outside) {
            traced = trace_in_world(ray);
            outside = 0;
        }
#endif
        const int entry = stack[--top];
#if HAS_INSTANCES
        if (entry >= INSTANCE_CHILD) {
            __global const Instance* in = bvh_instances + (entry - INSTANCE_CHILD);
            traced = trace_in_instance(ray, in);
            outside = top;
            stack[top++] = in->root;
            continue;
        }
#endif
        if (entry < 0) {
            __global const float_k* rows = bvh_blocks + (~entry >> 4) * BLOCK_ROWS;
            const PreparedBlock block = prepare_block(rows, traced.ray.origin);
            uint found =
                lanes_k(hit_block(&block, traced.ray.direction, traced.size, ray.end, true).hit);
#if HAS_ALPHA
            __global const uint* triangles = (__global const uint*)(rows + 9);
            for (; found; found &= found - 1u) {
                const uint lane = lowest(found);
                if (is_block_there(&block, lane, traced.ray.origin, traced.ray.direction,
                                   triangles[lane],
                                   triangles[lane] + traced.renumber ALPHA_ARGUMENTS))
                    break;
            }
#endif
            if (found) return true;
            continue;
        }
        __global const float_w* node = bvh_nodes + entry * 7;
        __global const int* children = (__global const int*)(node + 6);
        float_w near;
        for (uint lanes = lanes_w(enter_children(node, &traced.prepared, ray.end, &near)); lanes;
             lanes &= lanes - 1u)
            stack[top++] = children[lowest(lanes)];
    }
    return false;
}

// The hit with the smallest t beyond `start`.
static Hit closest_hit(BVH_PARAMETERS, Ray ray, float start) {
    Traced traced = trace_in_world(ray);
    Hit hit = {~0u, ray.end};
    int stack[BVH_STACK];
    float distance[BVH_STACK];
    int top = 0;
    stack[top] = 0;
    distance[top++] = 0.0f;
#if HAS_INSTANCES
    int outside = 0;  // as in occluded()
#endif
    while (top > 0) {
#if HAS_INSTANCES
        if (top == outside) {
            traced = trace_in_world(ray);
            outside = 0;
        }
#endif
        const int entry = stack[--top];
        if (distance[top] > ray.end) continue;
#if HAS_INSTANCES
        if (entry >= INSTANCE_CHILD) {
            __global const Instance* in = bvh_instances + (entry - INSTANCE_CHILD);
            traced = trace_in_instance(ray, in);
            outside = top;
            stack[top++] = in->root;  // at the same distance
            continue;
        }
#endif
        if (entry < 0) {
            __global const float_k* block = bvh_blocks + (~entry >> 4) * BLOCK_ROWS;
            const PreparedBlock ready = prepare_block(block, traced.ray.origin);
            const BlockHits hits =
                hit_block(&ready, traced.ray.direction, traced.size, ray.end, false);
            const uint found = lanes_k(hits.hit);
            if (!found) continue;
            __global const uint* triangles = (__global const uint*)(block + 9);
            float t[BVH_BLOCK] __attribute__((aligned(64)));
            *(float_k*)t = hits.t / hits.n;
            for (uint lanes = found; lanes; lanes &= lanes - 1u) {
                const uint lane = lowest(lanes);
                if (t[lane] >= hit.t || t[lane] <= start) continue;
#if HAS_ALPHA
                if (!is_block_there(&ready, lane, traced.ray.origin, traced.ray.direction,
                                    triangles[lane],
                                    triangles[lane] + traced.renumber ALPHA_ARGUMENTS))
                    continue;
#endif
                hit.triangle = triangles[lane] + traced.renumber;
                hit.t = t[lane];
            }
            ray.end = hit.t;
            continue;
        }
        __global const float_w* node = bvh_nodes + entry * 7;
        __global const int* children = (__global const int*)(node + 6);
        float near[BVH_WIDTH] __attribute__((aligned(64)));
        float nearest = INFINITY;
        float_w enter;
        uint lanes = lanes_w(enter_children(node, &traced.prepared, ray.end, &enter));
        *(float_w*)near = enter;
        for (; lanes; lanes &= lanes - 1u) {  // the nearest child ends on top of the stack
            const uint lane = lowest(lanes);
            stack[top] = children[lane];
            distance[top] = near[lane];
            if (near[lane] >= nearest) {
                stack[top] = stack[top - 1];
                distance[top] = distance[top - 1];
                stack[top - 1] = children[lane];
                distance[top - 1] = near[lane];
            } else {
                nearest = near[lane];
            }
            ++top;
        }
    }
    return hit;
}

// The weights of vertices 1 and 2 where a ray meets a triangle's plane.
static float2 hit_weights(Ray ray, float3 vertex, float3 edge1, float3 edge2) {
    const float3 a = vertex - ray.origin;
    const float n = dot(ray.direction, cross(edge1, edge2));
    return (float2)(dot(ray.direction, cross(edge2, a)), dot(ray.direction, cross(a, edge1))) / n;
}

#endif

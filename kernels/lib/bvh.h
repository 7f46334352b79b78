// SPDX-License-Identifier: MIT
// Ray against wide BVH, one ray per work-item, all children or triangles of a node at once.
//
// Layout (host/bvh/wide.hpp): a node is 7 vectors of BVH_WIDTH lanes: lower x y z, upper x y z,
// children. A child >= 0 is a node; < 0 is a leaf, ~(block << 4 | triangles - 1); empty lanes have
// inverted bounds and child -1. A block is 10 vectors of BVH_BLOCK lanes: vertices 0, 1, 2, each x
// y z, and the triangle's index; empty lanes are zero, a triangle that no ray hits.
#ifndef MANYLIGHT_LIB_BVH_H
#define MANYLIGHT_LIB_BVH_H

#include "lib/common.h"

#define JOIN_TOKENS(a, b) a##b
#define JOIN(a, b) JOIN_TOKENS(a, b)

typedef JOIN(float, BVH_WIDTH) float_w;
typedef JOIN(int, BVH_WIDTH) int_w;
typedef JOIN(float, BVH_BLOCK) float_k;
typedef JOIN(int, BVH_BLOCK) int_k;

// A set of lanes as one integer, a bit per lane at stride 8 (16 lanes: two interleaved halves).
// PoCL turns these conversions of a comparison into one mask move; any() becomes branches.
#define lanes_4(comparison) (ulong)(as_uint(convert_char4(comparison)) & 0x01010101u)
#define lanes_8(comparison) (as_ulong(convert_char8(comparison)) & 0x0101010101010101ul)
static ulong lanes_16(int16 comparison) {
    const ulong2 bytes = as_ulong2(convert_char16(comparison));
    return (bytes.x & 0x0101010101010101ul) | ((bytes.y & 0x0101010101010101ul) << 1);
}
#define lanes_w JOIN(lanes_, BVH_WIDTH)
#define lanes_k JOIN(lanes_, BVH_BLOCK)

// The lane of the lowest bit set; OpenCL C 1.2 has clz but not ctz.
static uint first_lane(ulong lanes) {
    const uint bit = 63u - (uint)clz(lanes & (0ul - lanes));
    return (bit >> 3) + ((bit & 1u) << 3);
}

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
    float u;  // weight of vertex 1
    float v;  // weight of vertex 2
} Hit;

#define BVH_PARAMETERS __global const float_w *bvh_nodes, __global const float_k *bvh_blocks
#define BVH_ARGUMENTS bvh_nodes, bvh_blocks

// What the tests of boxes and triangles need of a ray.
typedef struct Prepared {
    float3 inverse;  // slabs: planes at p are crossed at p * inverse + bias
    float3 bias;
    int near_x, near_y, near_z;  // which of a node's vectors holds the plane that is met first
    float3 origin;               // triangles: axes permuted so that the last is the ray's longest
    float3 shear;
    int x, y, z;
} Prepared;

static float safe_inverse(float d) {
    // Far below any direction that matters; its inverse times any coordinate stays finite.
    return 1.0f / (fabs(d) < 1e-20f ? copysign(1e-20f, d) : d);
}

static Prepared prepare_ray(Ray ray) {
    const float3 o = ray.origin;
    const float3 d = ray.direction;
    Prepared p;
    p.inverse = (float3)(safe_inverse(d.x), safe_inverse(d.y), safe_inverse(d.z));
    p.bias = -o * p.inverse;
    p.near_x = p.inverse.x < 0.0f ? 3 : 0;
    p.near_y = p.inverse.y < 0.0f ? 4 : 1;
    p.near_z = p.inverse.z < 0.0f ? 5 : 2;
    const float3 size = fabs(d);
    p.z = size.x > size.y ? (size.x > size.z ? 0 : 2) : (size.y > size.z ? 1 : 2);
    p.x = p.z == 2 ? 0 : p.z + 1;
    p.y = p.x == 2 ? 0 : p.x + 1;
    const float3 axes = p.z == 0 ? d.yzx : p.z == 1 ? d.zxy : d;
    p.origin = p.z == 0 ? o.yzx : p.z == 1 ? o.zxy : o;
    p.shear = (float3)(axes.x, axes.y, 1.0f) / axes.z;
    return p;
}

// The children whose boxes the segment enters; `entry` gets where. Boxes are padded on the host by
// more than the rounding error of these operations (host/bvh/wide.hpp).
static ulong enter_children(__global const float_w* node, const Prepared* s, float end,
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
    return lanes_w(*entry <= leave);
}

typedef struct BlockHits {
    float_k t, u, v;
    ulong lanes;
} BlockHits;

// Woop, Benthin, Wald, "Watertight Ray/Triangle Intersection" (JCGT 2:1, 2013): vertices are
// sheared so that the ray runs along z, and the edge functions of a shared edge are exact negatives
// of each other in its two triangles, for which they must not be fused.
static BlockHits hit_block(__global const float_k* block, const Prepared* p, float end) {
    const float_k ox = p->origin.x, oy = p->origin.y, oz = p->origin.z;
    const float_k shear_x = -p->shear.x, shear_y = -p->shear.y;
    const float_k az = block[p->z] - oz;
    const float_k bz = block[3 + p->z] - oz;
    const float_k cz = block[6 + p->z] - oz;
    const float_k ax = fma(shear_x, az, block[p->x] - ox);
    const float_k ay = fma(shear_y, az, block[p->y] - oy);
    const float_k bx = fma(shear_x, bz, block[3 + p->x] - ox);
    const float_k by = fma(shear_y, bz, block[3 + p->y] - oy);
    const float_k cx = fma(shear_x, cz, block[6 + p->x] - ox);
    const float_k cy = fma(shear_y, cz, block[6 + p->y] - oy);
    const float_k edge_a = cx * by - cy * bx;
    const float_k edge_b = ax * cy - ay * cx;
    const float_k edge_c = bx * ay - by * ax;
    const float_k inverse = 1.0f / (edge_a + edge_b + edge_c);  // empty lanes: 0 / 0, no hit
    BlockHits hits;
    hits.u = edge_b * inverse;
    hits.v = edge_c * inverse;
    hits.t = fma(edge_a, az, fma(edge_b, bz, edge_c * cz)) * (inverse * p->shear.z);
    const float_k lowest = min(min(edge_a, edge_b), edge_c);
    const float_k highest = max(max(edge_a, edge_b), edge_c);
    hits.lanes = lanes_k(((lowest >= 0.0f) | (highest <= 0.0f)) & (hits.t > 0.0f) & (hits.t < end));
    return hits;
}

// Whether anything is hit within the segment.
static bool occluded(BVH_PARAMETERS, Ray ray) {
    const Prepared prepared = prepare_ray(ray);
    int stack[BVH_STACK];
    int top = 0;
    stack[top++] = 0;
    while (top > 0) {
        const int entry = stack[--top];
        if (entry < 0) {
            if (hit_block(bvh_blocks + (~entry >> 4) * 10, &prepared, ray.end).lanes) return true;
            continue;
        }
        __global const float_w* node = bvh_nodes + entry * 7;
        __global const int* children = (__global const int*)(node + 6);
        float_w near;
        for (ulong lanes = enter_children(node, &prepared, ray.end, &near); lanes;
             lanes &= lanes - 1ul)
            stack[top++] = children[first_lane(lanes)];
    }
    return false;
}

// The hit with the smallest t.
static Hit closest_hit(BVH_PARAMETERS, Ray ray) {
    const Prepared prepared = prepare_ray(ray);
    Hit hit = {~0u, ray.end, 0.0f, 0.0f};
    int stack[BVH_STACK];
    float distance[BVH_STACK];
    int top = 0;
    stack[top] = 0;
    distance[top++] = 0.0f;
    while (top > 0) {
        const int entry = stack[--top];
        if (distance[top] > ray.end) continue;
        if (entry < 0) {
            __global const float_k* block = bvh_blocks + (~entry >> 4) * 10;
            const BlockHits hits = hit_block(block, &prepared, ray.end);
            if (!hits.lanes) continue;
            __global const uint* triangles = (__global const uint*)(block + 9);
            float t[BVH_BLOCK] __attribute__((aligned(64)));
            float u[BVH_BLOCK] __attribute__((aligned(64)));
            float v[BVH_BLOCK] __attribute__((aligned(64)));
            *(float_k*)t = hits.t;
            *(float_k*)u = hits.u;
            *(float_k*)v = hits.v;
            for (ulong lanes = hits.lanes; lanes; lanes &= lanes - 1ul) {
                const uint lane = first_lane(lanes);
                if (t[lane] >= hit.t) continue;
                hit.triangle = triangles[lane];
                hit.t = t[lane];
                hit.u = u[lane];
                hit.v = v[lane];
            }
            ray.end = hit.t;
            continue;
        }
        __global const float_w* node = bvh_nodes + entry * 7;
        __global const int* children = (__global const int*)(node + 6);
        float near[BVH_WIDTH] __attribute__((aligned(64)));
        float nearest = INFINITY;
        float_w enter;
        ulong lanes = enter_children(node, &prepared, ray.end, &enter);
        *(float_w*)near = enter;
        for (; lanes; lanes &= lanes - 1ul) {  // the nearest child ends on top of the stack
            const uint lane = first_lane(lanes);
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

#endif

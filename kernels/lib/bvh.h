// SPDX-License-Identifier: MIT
// Ray against wide BVH, one ray per work-item, all children or triangles of a node at once.
//
// Layout (host/bvh/wide.hpp): a node is 7 vectors of BVH_WIDTH lanes: lower x y z, upper x y z,
// children. A child >= 0 is a node or, from INSTANCE_CHILD on, an instance; < 0 is a leaf,
// ~(block << 4 | triangles - 1); empty lanes have inverted bounds and child -1. A block is 13
// vectors of BVH_BLOCK lanes: vertex 0, vertex 1 - vertex 0, vertex 2 - vertex 0, each x y z, the
// triangle's index, and the largest coordinate of each edge, the third from vertex 1 to vertex 2;
// empty lanes are zero, a triangle that no ray hits.
#ifndef MANYLIGHT_LIB_BVH_H
#define MANYLIGHT_LIB_BVH_H

#include "lib/alpha.h"
#include "lib/common.h"
#include "lib/instances.h"
#include "lib/lanes.h"

#define BLOCK_ROWS 13

typedef JOIN(float, BVH_WIDTH) float_w;
typedef JOIN(int, BVH_WIDTH) int_w;
typedef JOIN(float, BVH_BLOCK) float_k;
typedef JOIN(int, BVH_BLOCK) int_k;

#define lanes_w JOIN(lanes_, BVH_WIDTH)
#define lanes_k JOIN(lanes_, BVH_BLOCK)

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

#define as_int_k JOIN(as_int, BVH_BLOCK)
#define as_float_k JOIN(as_float, BVH_BLOCK)

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

// Rays as close to an edge as rounding may have taken them hit the triangles on both of its sides,
// so that none passes in between.
#define MARGIN_SCALE 1e-6f

// What the test of a block's triangles (Moller and Trumbore, "Fast, Minimum Storage Ray/Triangle
// Intersection", 1997) needs, for all rays of one origin: dot products with a ray's direction give
// the determinant (n), and, times it, the weights of vertices 1 (q), 2 (r) and 0 (s), each from
// its own edge: as 1 - u - v the last would lose its precision in slivers.
typedef struct PreparedBlock {
    float_k n[3], q[3], r[3], s[3];
    float_k t;  // t times the determinant; 0 where its sign may be rounding's
    // With its sign, the most that it may be before it was rounded.
    float_k most_t;
    // For directions whose largest part is 1: by how much the weights times the determinant may be
    // negative, below what determinant the ray lies in the triangle's plane, and by how much the
    // determinant may be rounded up.
    float_k margin_u, margin_v, margin_w, least_n, surplus_n;
} PreparedBlock;

// A ray that starts or ends on a triangle must not be occluded by it, however large it is and
// however rounded its plane. With e = 2^-23, vertex 0 at a from the origin and edges f and g, the
// normal is n_x = f_y g_z - f_z g_y, off by 2 e m_x where m_x = |f_y g_z| + |f_z g_y|, half of that
// because edges are rounded, and so on; a is off by e/2, and a . n is rounded three times more on
// its way: |a|.m 4 e in all. A determinant d . n with a direction that is off by e/2 itself is off
// by as much times |d|.m. m bounds what cancels in the normal, axis by axis: of a level ground,
// only heights above it count, not how far it goes. (Pharr, Jakob, Humphreys, "Physically Based
// Rendering" 4th ed., 6.8.7, bounds a . n so.)
#define ROUNDING_SCALE 5e-7f

static PreparedBlock prepare_block(__global const float_k* block, float3 origin) {
    const float_k ax = block[0] - origin.x, ay = block[1] - origin.y, az = block[2] - origin.z;
    const float_k fx = block[3], fy = block[4], fz = block[5];
    const float_k gx = block[6], gy = block[7], gz = block[8];
    PreparedBlock b;
    const float_k px = fz * gy, py = fx * gz, pz = fy * gx;
    b.n[0] = fma(fy, gz, -px);
    b.n[1] = fma(fz, gx, -py);
    b.n[2] = fma(fx, gy, -pz);
    b.q[0] = fma(gy, az, -gz * ay);
    b.q[1] = fma(gz, ax, -gx * az);
    b.q[2] = fma(gx, ay, -gy * ax);
    b.r[0] = fma(ay, fz, -az * fy);
    b.r[1] = fma(az, fx, -ax * fz);
    b.r[2] = fma(ax, fy, -ay * fx);
    const float_k t = fma(ax, b.n[0], fma(ay, b.n[1], az * b.n[2]));
    const float_k two = (float_k)(2.0f);
    const float_k mx = fma(two, fabs(px), fabs(b.n[0])), my = fma(two, fabs(py), fabs(b.n[1])),
                  mz = fma(two, fabs(pz), fabs(b.n[2]));
    const float_k rounding = fma(fabs(ax), mx, fma(fabs(ay), my, fabs(az) * mz)) * ROUNDING_SCALE;
    const int_k sure = fabs(t) > rounding;
    b.t = select((float_k)(0.0f), t, sure);
    b.most_t = select((float_k)(0.0f), t + copysign(rounding, t), sure);
    b.surplus_n = (mx + my + mz) * ROUNDING_SCALE;
    const float_k bx = ax + fx, by = ay + fy, bz = az + fz;
    const float_k hx = gx - fx, hy = gy - fy, hz = gz - fz;
    b.s[0] = fma(by, hz, -bz * hy);
    b.s[1] = fma(bz, hx, -bx * hz);
    b.s[2] = fma(bx, hy, -by * hx);
    const float_k far = max(max(fabs(ax), fabs(ay)), fabs(az)) * MARGIN_SCALE;
    b.margin_u = far * block[11];
    b.margin_v = far * block[10];
    b.margin_w = fma(block[10], MARGIN_SCALE, far) * block[12];
    b.least_n = max(max(fabs(b.n[0]), fabs(b.n[1])), fabs(b.n[2])) * MARGIN_SCALE;
    return b;
}

typedef struct BlockHits {
    float_k t, n;  // t and what it is to be divided by
    int_k hit;
} BlockHits;

// One ray against all triangles; `size` is the largest part of its direction. Those that `occlude`
// are hit before its end, however that is rounded; t is meaningless then.
static BlockHits hit_block(const PreparedBlock* b, float3 direction, float size, float end,
                           const bool occlude) {
    const float_k x = direction.x, y = direction.y, z = direction.z;
    const float_k n = fma(x, b->n[0], fma(y, b->n[1], z * b->n[2]));
    const float_k q = fma(x, b->q[0], fma(y, b->q[1], z * b->q[2]));
    const float_k r = fma(x, b->r[0], fma(y, b->r[1], z * b->r[2]));
    const int_k sign = as_int_k(n) & (int)0x80000000;
    const float_k u = as_float_k(as_int_k(q) ^ sign);
    const float_k v = as_float_k(as_int_k(r) ^ sign);
    BlockHits hits;
    hits.n = fabs(n);
    hits.t = as_float_k(as_int_k(occlude ? b->most_t : b->t) ^ sign);
    const float_k s = fma(x, b->s[0], fma(y, b->s[1], z * b->s[2]));
    const float_k w = as_float_k(as_int_k(s) ^ sign);
    const float_k inside =
        min(min(fma(b->margin_u, size, u), fma(b->margin_v, size, v)), fma(b->margin_w, size, w));
    hits.hit = (inside >= 0.0f) & (hits.t > 0.0f);
    if (occlude)
        hits.hit &= hits.t < fma(b->surplus_n, (float_k)(-size), hits.n) * end;
    else
        hits.hit &= (hits.n > b->least_n * size) & (hits.t < hits.n * end);
    return hits;
}

#if HAS_ALPHA
// is_there() for a triangle of a block.
static bool is_block_there(const PreparedBlock* b, uint lane, float3 origin, float3 d,
                           uint triangle, uint seen ALPHA_PARAMETERS) {
#define DOT(v) (d.x * LANE((v)[0], lane) + d.y * LANE((v)[1], lane) + d.z * LANE((v)[2], lane))
    const float n = DOT(b->n);
    return is_there(origin, d, triangle, seen, (float2)(DOT(b->q), DOT(b->r)) / n,
                    n > 0.0f ALPHA_ARGUMENTS);
#undef DOT
}
#endif

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

// The hit with the smallest t.
static Hit closest_hit(BVH_PARAMETERS, Ray ray) {
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
                if (t[lane] >= hit.t) continue;
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

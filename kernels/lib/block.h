// SPDX-License-Identifier: MIT
// Ray against a block of triangles, all of them at once: the leaves of lib/bvh.h.
//
// Layout (host/bvh/wide.hpp): a block is 13 vectors of BVH_BLOCK lanes: vertex 0, vertex 1 - vertex
// 0, vertex 2 - vertex 0, each x y z, the triangle's index, and the largest coordinate of each
// edge, the third from vertex 1 to vertex 2; empty lanes are zero, a triangle that no ray hits.
#ifndef MANYLIGHT_LIB_BLOCK_H
#define MANYLIGHT_LIB_BLOCK_H

#include "lib/alpha.h"
#include "lib/common.h"
#include "lib/lanes.h"

#define BLOCK_ROWS 13

typedef JOIN(float, BVH_BLOCK) float_k;
typedef JOIN(int, BVH_BLOCK) int_k;

#define lanes_k JOIN(lanes_, BVH_BLOCK)
#define as_int_k JOIN(as_int, BVH_BLOCK)
#define as_float_k JOIN(as_float, BVH_BLOCK)

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

#endif

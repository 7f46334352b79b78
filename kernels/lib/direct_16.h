// SPDX-License-Identifier: MIT
// One light at 16 surface points: as lib/direct.h and lib/lights.h, by coordinates.
#ifndef MANYLIGHT_LIB_DIRECT_16_H
#define MANYLIGHT_LIB_DIRECT_16_H

// Includes lib/node_estimate.h with LANES 16 before.

// Where shadow rays start, and unit geometric normals.
typedef struct Origins_16 {
    float16 x, y, z, gx, gy, gz;
} Origins_16;

// f Le G without visibility, cd/m2, and the rays that have to be free to `end`.
typedef struct Direct_16 {
    Color_16 value;
    float16 x, y, z;
    float end;
} Direct_16;

// The light, or its points (u, v), as lib/lights.h has them.
static Direct_16 direct_16(__global const Light* light, uint kind, const Points_16* p,
                           const Origins_16* from, float16 u, float16 v) {
    const float16 zero = (float16)(0.0f);
    float16 tx, ty, tz;  // where the rays end
    float16 wx, wy, wz;
    float16 emitted;
    Direct_16 d;
    d.end = 1.0f;
#if HAS_DIRECTIONAL
    if (kind == LIGHT_DIRECTIONAL) {
        d.end = INFINITY;
        wx = (float16)(-light->axis.x);
        wy = (float16)(-light->axis.y);
        wz = (float16)(-light->axis.z);
        emitted = (float16)(1.0f);
    } else
#endif
    {
        const float3 position = light->position.xyz;
        tx = (float16)(position.x);
        ty = (float16)(position.y);
        tz = (float16)(position.z);
#if HAS_TRIANGLE || HAS_QUAD
        if (kind == LIGHT_TRIANGLE || kind == LIGHT_QUAD) {
            const float3 axis = light->axis.xyz;
            const float3 edge = light->edge.xyz;
            if (kind == LIGHT_TRIANGLE) {
                const int16 beyond = u + v > 1.0f;
                u = select(u, 1.0f - u, beyond);
                v = select(v, 1.0f - v, beyond);
            }
            tx += axis.x * u + edge.x * v;
            ty += axis.y * u + edge.y * v;
            tz += axis.z * u + edge.z * v;
        }
#endif
        const float16 dx = tx - p->px, dy = ty - p->py, dz = tz - p->pz;
        const float16 squared = dot3_16(dx, dy, dz, dx, dy, dz);
        const float16 inverse = 1.0f / sqrt(max(squared, 1e-30f));
        wx = dx * inverse;
        wy = dy * inverse;
        wz = dz * inverse;
        emitted = inverse * inverse;
        switch (kind) {
#if HAS_POINT || HAS_SPOT
            case LIGHT_POINT:
            case LIGHT_SPOT: {
                const float range = light->axis.w;
                if (range > 0.0f) {
                    const float16 ratio = squared / (range * range);
                    emitted *= clamp(1.0f - ratio * ratio, 0.0f, 1.0f);
                }
                if (kind == LIGHT_SPOT) {
                    const float3 a = light->axis.xyz;
                    const float16 cosine =
                        -dot3_16(wx, wy, wz, (float16)(a.x), (float16)(a.y), (float16)(a.z));
                    const float16 cone = clamp(cosine * light->edge.x + light->edge.y, 0.0f, 1.0f);
                    emitted *= cone * cone;
                }
                break;
            }
#endif
#if HAS_ORIENTED || HAS_TRIANGLE || HAS_QUAD
            default: {  // cosines; an area's normal is as long as the parallelogram is large
                const float3 axis = light->axis.xyz;
                const float3 n = kind == LIGHT_ORIENTED ? axis : cross(axis, light->edge.xyz);
                const float16 cosine =
                    -dot3_16(wx, wy, wz, (float16)(n.x), (float16)(n.y), (float16)(n.z));
                const bool both = kind != LIGHT_ORIENTED && light->axis.w != 0.0f;
                const float share = kind == LIGHT_TRIANGLE ? 0.5f : 1.0f;
                emitted *= share * (both ? fabs(cosine) : max(cosine, zero));
                const float offset = light->edge.w / length(n);
                const float16 side = select((float16)(offset), (float16)(-offset), cosine < 0.0f);
                tx += n.x * side;
                ty += n.y * side;
                tz += n.z * side;
            }
#endif
        }
    }
    const float16 cosine = dot3_16(p->nx, p->ny, p->nz, wx, wy, wz);
    const int16 lit = (cosine > 0.0f) & (dot3_16(from->gx, from->gy, from->gz, wx, wy, wz) > 0.0f);
    d.value =
        reflect_16(p, wx, wy, wz, zero, select(zero, cosine * emitted, lit), light->emission.xyz);
    const bool infinite = d.end == INFINITY;
    d.x = infinite ? wx : tx - from->x;
    d.y = infinite ? wy : ty - from->y;
    d.z = infinite ? wz : tz - from->z;
    return d;
}

#endif

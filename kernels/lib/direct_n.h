// SPDX-License-Identifier: MIT
// LANES lights, each at a surface point of its own: as lib/direct.h and lib/lights.h, by
// coordinates.
#ifndef MANYLIGHT_LIB_DIRECT_N_H
#define MANYLIGHT_LIB_DIRECT_N_H

#include "lib/receivers_n.h"

// Fields: shared/light.h. Lanes whose kind is none of them hold no light.
typedef struct Lights_n {
    uint_n kind;
    float_n x, y, z;
    float_n ax, ay, az, aw;
    float_n ex, ey, ez, ew;
    float_n red, green, blue;
} Lights_n;

#define NO_LIGHT 0xffffffffu

INLINE Lights_n load_lights_n(__global const Light* lights, uint_n indices, int_n valid) {
    float_n rows[16];
    load_columns((__global const float*)lights, sizeof(Light) / sizeof(float), indices, rows);
    Lights_n l = {(uint_n)(NO_LIGHT),
                  rows[0],
                  rows[1],
                  rows[2],
                  rows[4],
                  rows[5],
                  rows[6],
                  rows[7],
                  rows[8],
                  rows[9],
                  rows[10],
                  rows[11],
                  rows[12],
                  rows[13],
                  rows[14]};
    l.kind = select(l.kind, OF_LANES(convert_uint)(rows[3]), as_uint_n(valid));
    return l;
}

// f Le G without visibility, cd/m2, and the rays that have to be free to `end`. Lanes without
// light: 0.
typedef struct Direct_n {
    Color_n value;
    float_n x, y, z, end;
} Direct_n;

// The lights, or their points (u, v), as lib/lights.h has them.
INLINE Direct_n direct_n(const Lights_n* l, const Points_n* p, const Origins_n* from, float_n u,
                         float_n v) {
    const float_n zero = (float_n)(0.0f), one = (float_n)(1.0f);
    const float_n px = p->px, py = p->py, pz = p->pz;
    float_n tx = l->x, ty = l->y, tz = l->z;  // where the rays end
    float_n solid_angle = zero;
#if HAS_TRIANGLE || HAS_QUAD
    const int_n triangle = l->kind == LIGHT_TRIANGLE;
    const int_n area = triangle | (l->kind == LIGHT_QUAD);
#if HAS_TRIANGLE
    const int_n beyond = triangle & (u + v > 1.0f);
    u = select(u, 1.0f - u, beyond);
    v = select(v, 1.0f - v, beyond);
#endif
    tx = select(tx, tx + l->ax * u + l->ex * v, area);
    ty = select(ty, ty + l->ay * u + l->ey * v, area);
    tz = select(tz, tz + l->az * u + l->ez * v, area);
#endif
    const float_n dx = tx - px, dy = ty - py, dz = tz - pz;
    const float_n squared = dot3_n(dx, dy, dz, dx, dy, dz);
    const float_n inverse = inverse_root_n(max(squared, 1e-30f));
    float_n wx = dx * inverse, wy = dy * inverse, wz = dz * inverse;
    float_n emitted = zero;  // times the distance squared
#if HAS_POINT || HAS_SPOT
    const float_n ratio = squared * inverse_n(clamp(l->aw * l->aw, 1e-30f, 1e30f));
    const float_n within = select(clamp(1.0f - ratio * ratio, 0.0f, 1.0f), one, l->aw == 0.0f);
#endif
#if HAS_POINT
    emitted = select(emitted, within, l->kind == LIGHT_POINT);
#endif
#if HAS_SPOT
    const float_n off_axis = -dot3_n(wx, wy, wz, l->ax, l->ay, l->az);
    const float_n versine = versine_n(off_axis, wx, wy, wz, l->ax, l->ay, l->az);
    const float_n cone = clamp((l->ey - versine) * l->ex, 0.0f, 1.0f);
    emitted = select(emitted, within * cone * cone, l->kind == LIGHT_SPOT);
#endif
#if HAS_ORIENTED || HAS_TRIANGLE || HAS_QUAD
    // Cosines; an area's normal is as long as the parallelogram is large.
    float_n nx = l->ax, ny = l->ay, nz = l->az;
    int_n oriented = l->kind == LIGHT_ORIENTED;
#if HAS_TRIANGLE || HAS_QUAD
    nx = select(nx, l->ay * l->ez - l->az * l->ey, area);
    ny = select(ny, l->az * l->ex - l->ax * l->ez, area);
    nz = select(nz, l->ax * l->ey - l->ay * l->ex, area);
#endif
    const float_n cosine = -dot3_n(wx, wy, wz, nx, ny, nz);
    float_n facing = max(cosine, zero);
#if HAS_TRIANGLE || HAS_QUAD
    facing = select(facing, fabs(cosine), area & (l->aw != 0.0f));
    facing = select(facing, 0.5f * facing, triangle);
    oriented = oriented | area;
    solid_angle = select(zero, facing * inverse * inverse * from->reflects, area);
#endif
    emitted = select(emitted, facing, oriented);
    // The square of a small area would be too small for a float.
    const float_n scale = inverse_n(max(max(max(fabs(nx), fabs(ny)), fabs(nz)), 1e-30f));
    nx *= scale;
    ny *= scale;
    nz *= scale;
    const float_n offset = l->ew * inverse_root_n(max(dot3_n(nx, ny, nz, nx, ny, nz), 1e-30f));
    const float_n side = select(zero, select(offset, -offset, cosine < 0.0f), oriented);
    tx += nx * side;
    ty += ny * side;
    tz += nz * side;
#endif
    emitted *= inverse * inverse;
    Direct_n d;
    d.x = tx - from->x;
    d.y = ty - from->y;
    d.z = tz - from->z;
    d.end = one;
#if HAS_DIRECTIONAL
    const int_n infinite = l->kind == LIGHT_DIRECTIONAL;
    wx = select(wx, -l->ax, infinite);
    wy = select(wy, -l->ay, infinite);
    wz = select(wz, -l->az, infinite);
    emitted = select(emitted, one, infinite);
    d.x = select(d.x, wx, infinite);
    d.y = select(d.y, wy, infinite);
    d.z = select(d.z, wz, infinite);
    const float_n to_plane = dot3_n(l->ax, l->ay, l->az, from->x, from->y, from->z) - l->ex;
    const float_n end = select(max(to_plane, 1e-30f), (float_n)(INFINITY), l->ey == 0.0f);
    d.end = select(d.end, end, infinite);
#endif
    const float_n incident = dot3_n(p->nx, p->ny, p->nz, wx, wy, wz);
    const int_n lit = (incident > 0.0f) & (dot3_n(from->gx, from->gy, from->gz, wx, wy, wz) > 0.0f);
    d.value = reflect_n(p, wx, wy, wz, zero, solid_angle, select(zero, incident * emitted, lit));
    d.value.red *= l->red;
    d.value.green *= l->green;
    d.value.blue *= l->blue;
    return d;
}

#endif

// SPDX-License-Identifier: MIT
// 16 lights, each at a surface point of its own: as lib/direct.h and lib/lights.h, by coordinates.
#ifndef MANYLIGHT_LIB_DIRECT_16_H
#define MANYLIGHT_LIB_DIRECT_16_H

#include "lib/receivers_16.h"

// Fields: shared/light.h. Lanes whose kind is none of them hold no light.
typedef struct Lights_16 {
    uint16 kind;
    float16 x, y, z;
    float16 ax, ay, az, aw;
    float16 ex, ey, ez, ew;
    float16 red, green, blue;
} Lights_16;

#define NO_LIGHT 0xffffffffu

static Lights_16 load_lights_16(__global const Light* lights, uint16 indices, int16 valid) {
    float16 rows[16];
    for (uint lane = 0u; lane < 16u; ++lane)
        rows[lane] = vload16(0, (__global const float*)(lights + UINT_LANE(indices, lane)));
    transpose_16(rows);
    Lights_16 l = {(uint16)(NO_LIGHT),
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
    l.kind = select(l.kind, convert_uint16(rows[3]), as_uint16(valid));
    return l;
}

// f Le G without visibility, cd/m2, and the rays that have to be free to `end`. Lanes without
// light: 0.
typedef struct Direct_16 {
    Color_16 value;
    float16 x, y, z, end;
} Direct_16;

// The lights, or their points (u, v), as lib/lights.h has them.
static Direct_16 direct_16(const Lights_16* l, const Points_16* p, const Origins_16* from,
                           float16 u, float16 v) {
    const float16 zero = (float16)(0.0f), one = (float16)(1.0f);
    const float16 px = p->px, py = p->py, pz = p->pz;
    float16 tx = l->x, ty = l->y, tz = l->z;  // where the rays end
    float16 solid_angle = zero;
#if HAS_TRIANGLE || HAS_QUAD
    const int16 triangle = l->kind == LIGHT_TRIANGLE;
    const int16 area = triangle | (l->kind == LIGHT_QUAD);
#if HAS_TRIANGLE
    const int16 beyond = triangle & (u + v > 1.0f);
    u = select(u, 1.0f - u, beyond);
    v = select(v, 1.0f - v, beyond);
#endif
    tx = select(tx, tx + l->ax * u + l->ex * v, area);
    ty = select(ty, ty + l->ay * u + l->ey * v, area);
    tz = select(tz, tz + l->az * u + l->ez * v, area);
#endif
    const float16 dx = tx - px, dy = ty - py, dz = tz - pz;
    const float16 squared = dot3_16(dx, dy, dz, dx, dy, dz);
    const float16 inverse = inverse_root_16(max(squared, 1e-30f));
    float16 wx = dx * inverse, wy = dy * inverse, wz = dz * inverse;
    float16 emitted = zero;  // times the distance squared
#if HAS_POINT || HAS_SPOT
    const float16 ratio = squared * inverse_16(clamp(l->aw * l->aw, 1e-30f, 1e30f));
    const float16 within = select(clamp(1.0f - ratio * ratio, 0.0f, 1.0f), one, l->aw == 0.0f);
#endif
#if HAS_POINT
    emitted = select(emitted, within, l->kind == LIGHT_POINT);
#endif
#if HAS_SPOT
    const float16 off_axis = -dot3_16(wx, wy, wz, l->ax, l->ay, l->az);
    const float16 cone = clamp(off_axis * l->ex + l->ey, 0.0f, 1.0f);
    emitted = select(emitted, within * cone * cone, l->kind == LIGHT_SPOT);
#endif
#if HAS_ORIENTED || HAS_TRIANGLE || HAS_QUAD
    // Cosines; an area's normal is as long as the parallelogram is large.
    float16 nx = l->ax, ny = l->ay, nz = l->az;
    int16 oriented = l->kind == LIGHT_ORIENTED;
#if HAS_TRIANGLE || HAS_QUAD
    nx = select(nx, l->ay * l->ez - l->az * l->ey, area);
    ny = select(ny, l->az * l->ex - l->ax * l->ez, area);
    nz = select(nz, l->ax * l->ey - l->ay * l->ex, area);
#endif
    const float16 cosine = -dot3_16(wx, wy, wz, nx, ny, nz);
    float16 facing = max(cosine, zero);
#if HAS_TRIANGLE || HAS_QUAD
    facing = select(facing, fabs(cosine), area & (l->aw != 0.0f));
    facing = select(facing, 0.5f * facing, triangle);
    oriented = oriented | area;
    solid_angle = select(zero, facing * inverse * inverse * from->reflects, area);
#endif
    emitted = select(emitted, facing, oriented);
    const float16 offset = l->ew * inverse_root_16(max(dot3_16(nx, ny, nz, nx, ny, nz), 1e-30f));
    const float16 side = select(zero, select(offset, -offset, cosine < 0.0f), oriented);
    tx += nx * side;
    ty += ny * side;
    tz += nz * side;
#endif
    emitted *= inverse * inverse;
    Direct_16 d;
    d.x = tx - from->x;
    d.y = ty - from->y;
    d.z = tz - from->z;
    d.end = one;
#if HAS_DIRECTIONAL
    const int16 infinite = l->kind == LIGHT_DIRECTIONAL;
    wx = select(wx, -l->ax, infinite);
    wy = select(wy, -l->ay, infinite);
    wz = select(wz, -l->az, infinite);
    emitted = select(emitted, one, infinite);
    d.x = select(d.x, wx, infinite);
    d.y = select(d.y, wy, infinite);
    d.z = select(d.z, wz, infinite);
    d.end = select(d.end, (float16)(INFINITY), infinite);
#endif
    const float16 incident = dot3_16(p->nx, p->ny, p->nz, wx, wy, wz);
    const int16 lit =
        (incident > 0.0f) & (dot3_16(from->gx, from->gy, from->gz, wx, wy, wz) > 0.0f);
    d.value = reflect_16(p, wx, wy, wz, zero, solid_angle, select(zero, incident * emitted, lit));
    d.value.red *= l->red;
    d.value.green *= l->green;
    d.value.blue *= l->blue;
    return d;
}

#endif

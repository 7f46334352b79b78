// SPDX-License-Identifier: MIT
// LANES lights, each at a surface point of its own: as lib/direct.h and lib/lights.h, by
// coordinates.
#ifndef MANYLIGHT_LIB_DIRECT_N_H
#define MANYLIGHT_LIB_DIRECT_N_H

#include "lib/lights.h"
#include "lib/receivers_n.h"

// Fields: shared/light.h. Lanes whose kind is none of them hold no light.
typedef struct Lights_n {
    uint_n kind;
    float_n x, y, z;
    float_n ax, ay, az, aw;
    float_n ex, ey, ez, ew;
    float_n red, green, blue;
} Lights_n;

#define NO_LIGHT_KIND 0xffffffffu  // of lanes without a light

INLINE Lights_n load_lights_n(__global const Light* lights, uint_n indices, int_n valid) {
    float_n rows[16];
    load_columns((__global const float*)lights, sizeof(Light) / sizeof(float), indices, rows);
    Lights_n l = {(uint_n)(NO_LIGHT_KIND),
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

// Lights, or points of them, as LANES surface points see them: lib/lights.h's LightSample for an
// emission of 1.
typedef struct LightSample_n {
    float_n wx, wy, wz;        // unit, to the light
    float_n squared, inverse;  // distance squared, 1 / distance
    float_n x, y, z;           // where the rays end, or the direction to what is infinitely far
    float_n end;               // of its rays, if a light is infinitely far, or else 0
    float_n emitted;
    float_n solid_angle;  // 0 where stage reflections takes no part
} LightSample_n;

INLINE LightSample_n sample_towards_n(const Points_n* p, float_n x, float_n y, float_n z) {
    LightSample_n s;
    s.x = x;
    s.y = y;
    s.z = z;
    const float_n dx = x - p->px, dy = y - p->py, dz = z - p->pz;
    s.squared = dot3_n(dx, dy, dz, dx, dy, dz);
    s.inverse = inverse_root_n(max(s.squared, 1e-30f));
    s.wx = dx * s.inverse;
    s.wy = dy * s.inverse;
    s.wz = dz * s.inverse;
    s.end = (float_n)(0.0f);
    s.emitted = (float_n)(0.0f);
    s.solid_angle = (float_n)(0.0f);
    return s;
}

#define FOR_LANES 1
#include "lights/kinds.h"
#undef FOR_LANES

#define CHOOSE(field) s->field = select(s->field, other->field, lanes)
INLINE void choose_samples_n(LightSample_n* s, const LightSample_n* other, int_n lanes) {
    CHOOSE(wx);
    CHOOSE(wy);
    CHOOSE(wz);
    CHOOSE(x);
    CHOOSE(y);
    CHOOSE(z);
    CHOOSE(end);
    CHOOSE(emitted);
    CHOOSE(solid_angle);
}
#undef CHOOSE

// The lights, or their points (u, v), of all kinds.
INLINE LightSample_n sample_lights_n(const Lights_n* l, const Points_n* p, const Origins_n* from,
                                     float_n u, float_n v) {
    LightSample_n all = sample_towards_n(p, l->x, l->y, l->z);
#define LIGHT_CASE(name, NAME, value, traits, centroid)                   \
    CODE_WHERE(                                                           \
        HAS_##NAME, if (lanes_n(l->kind == value) != 0u) {                \
            const LightSample_n own = light_##name##_n(l, p, from, u, v); \
            choose_samples_n(&all, &own, l->kind == value);               \
        })
    LIGHT_KINDS(LIGHT_CASE)
#undef LIGHT_CASE
    return all;
}

INLINE Direct_n direct_n(const Lights_n* l, const Points_n* p, const Origins_n* from, float_n u,
                         float_n v) {
    const LightSample_n s = sample_lights_n(l, p, from, u, v);
    Direct_n d;
    d.x = s.x - from->x;
    d.y = s.y - from->y;
    d.z = s.z - from->z;
    d.end = (float_n)(1.0f);
#if HAS_INFINITE
    const int_n infinite = s.end > 0.0f;
    d.x = select(d.x, s.x, infinite);
    d.y = select(d.y, s.y, infinite);
    d.z = select(d.z, s.z, infinite);
    d.end = select(d.end, s.end, infinite);
#endif
    const float_n zero = (float_n)(0.0f);
    const float_n incident = dot3_n(p->nx, p->ny, p->nz, s.wx, s.wy, s.wz);
    const int_n lit =
        (incident > 0.0f) & (dot3_n(from->gx, from->gy, from->gz, s.wx, s.wy, s.wz) > 0.0f);
    d.value = reflect_n(p, s.wx, s.wy, s.wz, zero, s.solid_angle,
                        select(zero, incident * s.emitted, lit));
    d.value.red *= l->red;
    d.value.green *= l->green;
    d.value.blue *= l->blue;
    return d;
}

#endif

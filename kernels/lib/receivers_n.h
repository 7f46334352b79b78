// SPDX-License-Identifier: MIT
// The LANES pixels of a group of a pass (lib/cells.h), as lib/direct.h's receivers, by coordinates.
// lib/node_estimate.h with WIDE_POINTS comes before.
#ifndef MANYLIGHT_LIB_RECEIVERS_N_H
#define MANYLIGHT_LIB_RECEIVERS_N_H

#include "lib/cells.h"
#include "lib/lanes.h"
#include "lib/view.h"

// Where shadow rays start, normals of the horizons, and 1 where stage reflections takes part.
typedef struct Origins_n {
    float_n x, y, z, gx, gy, gz, reflects;
} Origins_n;

// Pixels that see nothing are black.
typedef struct Receivers_n {
    Points_n points;
    Origins_n from;
    uint_n x, y;  // pixels
    int_n valid;
} Receivers_n;

// Sets a field of some lanes, of all at first.
#define SET_LANES(field, value) \
    p->field = left == ALL_LANES ? (float_n)(value) : select(p->field, (float_n)(value), lanes)
// What the lanes' materials have; most often they share one.
INLINE void load_materials_n(__global const Material* materials, uint_n indices, Points_n* p) {
    int_n todo = (int_n)(-1);
    for (uint left = ALL_LANES; left; left = lanes_n(todo)) {
        const uint index = UINT_LANE(indices, lowest(left));
        const int_n lanes = indices == index;
        todo = todo & !lanes;
        __global const Material* m = materials + index;
        SET_LANES(red, m->base_color.x);
        SET_LANES(green, m->base_color.y);
        SET_LANES(blue, m->base_color.z);
#if HAS_GGX
        SET_LANES(metallic, m->base_color.w);
        SET_LANES(alpha, m->roughness);
        SET_LANES(specular, m->specular);
#if HAS_REFLECTANCE
        SET_LANES(f0_red, m->reflectance.x);
        SET_LANES(f0_green, m->reflectance.y);
        SET_LANES(f0_blue, m->reflectance.z);
#endif
#endif
    }
}
#undef SET_LANES

#if HAS_OUTGOING
// Where the light of the lanes' items goes, and their throughput.
INLINE void load_outgoing_n(View view, uint_n items, Points_n* p) {
    for (uint lane = 0u; lane < LANES; ++lane) {
        __global const Outgoing* o = view + UINT_LANE(items, lane);
        SET_LANE(p->through_red, lane, o->throughput.x);
        SET_LANE(p->through_green, lane, o->throughput.y);
        SET_LANE(p->through_blue, lane, o->throughput.z);
#if HAS_GGX
        SET_LANE(p->vx, lane, o->direction.x);
        SET_LANE(p->vy, lane, o->direction.y);
        SET_LANE(p->vz, lane, o->direction.z);
#endif
    }
}
#endif

INLINE Receivers_n load_receivers_n(Tiles tiles, Pass pass, uint group, View view,
                                    __global const Surface* surfaces,
                                    __global const Material* materials) {
    const float_n zero = (float_n)(0.0f), one = (float_n)(1.0f);
    uint_n items;
    for (uint lane = 0u; lane < LANES; ++lane)
        UINT_LANE(items, lane) = pass_item(pass, LANES * group + lane);
    float_n rows[16];
    load_columns((__global const float*)surfaces, sizeof(Surface) / sizeof(float), items, rows);
    Receivers_n r;
    // Cells along a Morton curve, 4 pixels apart.
    const uint2 corner = item_pixel(tiles, pass_item(pass, LANES * group & ~15u));
    const uint_n cell = LANES * group % 16u + as_uint_n(lane_numbers());
    r.x = corner.x + 4u * (cell & 1u) + 2u * (cell & 4u);
    r.y = corner.y + 2u * (cell & 2u) + (cell & 8u);
    r.valid = as_int_n((r.x < tiles.width) & (r.y < tiles.height)) & (rows[3] >= 0.0f);
    r.points.px = select(one, rows[0], r.valid);
    r.points.py = select(one, rows[1], r.valid);
    r.points.pz = select(one, rows[2], r.valid);
    r.points.nx = select(one, rows[4], r.valid);
    r.points.ny = select(one, rows[5], r.valid);
    r.points.nz = select(one, rows[6], r.valid);
    r.from.gx = select(one, rows[8], r.valid);
    r.from.gy = select(one, rows[9], r.valid);
    r.from.gz = select(one, rows[10], r.valid);
    const float_n offset = select(zero, rows[11], r.valid);
    r.from.x = r.points.px + r.from.gx * offset;
    r.from.y = r.points.py + r.from.gy * offset;
    r.from.z = r.points.pz + r.from.gz * offset;
    r.from.reflects = zero;
    load_materials_n(materials, select((uint_n)(0u), as_uint_n(rows[15]), as_uint_n(r.valid)),
                     &r.points);
    r.points.red = select(zero, r.points.red, r.valid);
    r.points.green = select(zero, r.points.green, r.valid);
    r.points.blue = select(zero, r.points.blue, r.valid);
#if HAS_OUTGOING
    // Those of items without a surface may be anything.
    load_outgoing_n(view, items, &r.points);
    r.points.through_red = select(zero, r.points.through_red, r.valid);
    r.points.through_green = select(zero, r.points.through_green, r.valid);
    r.points.through_blue = select(zero, r.points.through_blue, r.valid);
#if HAS_GGX
    r.points.vx = select(one, r.points.vx, r.valid);
    r.points.vy = select(one, r.points.vy, r.valid);
    r.points.vz = select(one, r.points.vz, r.valid);
#endif
#endif
#if HAS_GGX
    Points_n* p = &r.points;
    p->metallic = select(zero, p->metallic, r.valid);
    p->specular = select(zero, p->specular, r.valid);
    const int_n shiny = (p->metallic > 0.0f) | (p->specular > 0.0f);
    p->glossy = lanes_n(shiny) != 0u;
#if !HAS_OUTGOING
    p->vx = (float_n)(-view.forward.x);
    p->vy = (float_n)(-view.forward.y);
    p->vz = (float_n)(-view.forward.z);
    if (view.forward.w == 0.0f) {
        p->vx = view.origin.x - p->px;
        p->vy = view.origin.y - p->py;
        p->vz = view.origin.z - p->pz;
        const float_n squared = dot3_n(p->vx, p->vy, p->vz, p->vx, p->vy, p->vz);
        const float_n inverse = inverse_root_n(max(squared, 1e-30f));
        p->vx *= inverse;
        p->vy *= inverse;
        p->vz *= inverse;
    }
#endif
#if HAS_REFLECTIONS
    const float_n out = dot3_n(p->nx, p->ny, p->nz, p->vx, p->vy, p->vz);
    r.from.reflects =
        select(zero, one, shiny & (p->alpha < REFLECTING_ALPHA) & (out > LEAST_COSINE));
#endif
#endif
    return r;
}

#define PERMUTE(field) p.field = permute_n(all->field, lanes)
// The points of other lanes.
INLINE Points_n permute_points(const Points_n* all, uint_n lanes) {
    Points_n p;
    PERMUTE(px);
    PERMUTE(py);
    PERMUTE(pz);
    PERMUTE(nx);
    PERMUTE(ny);
    PERMUTE(nz);
    PERMUTE(red);
    PERMUTE(green);
    PERMUTE(blue);
#if HAS_OUTGOING
    PERMUTE(through_red);
    PERMUTE(through_green);
    PERMUTE(through_blue);
#endif
#if HAS_GGX
    PERMUTE(vx);
    PERMUTE(vy);
    PERMUTE(vz);
    PERMUTE(metallic);
    PERMUTE(alpha);
    PERMUTE(specular);
#if HAS_REFLECTANCE
    PERMUTE(f0_red);
    PERMUTE(f0_green);
    PERMUTE(f0_blue);
#endif
    p.glossy = all->glossy;
#endif
    return p;
}

INLINE Origins_n permute_origins(const Origins_n* all, uint_n lanes) {
    Origins_n p;
    PERMUTE(x);
    PERMUTE(y);
    PERMUTE(z);
    PERMUTE(gx);
    PERMUTE(gy);
    PERMUTE(gz);
    PERMUTE(reflects);
    return p;
}
#undef PERMUTE

#endif

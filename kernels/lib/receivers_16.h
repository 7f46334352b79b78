// SPDX-License-Identifier: MIT
// The 16 pixels of a group of a pass (lib/cells.h), as lib/direct.h's receivers, by coordinates.
// lib/node_estimate.h for 16 lanes comes before.
#ifndef MANYLIGHT_LIB_RECEIVERS_16_H
#define MANYLIGHT_LIB_RECEIVERS_16_H

#include "lib/cells.h"
#include "lib/transpose_16.h"

// Where shadow rays start, unit geometric normals, and 1 where stage reflections takes part.
typedef struct Origins_16 {
    float16 x, y, z, gx, gy, gz, reflects;
} Origins_16;

// Pixels that see nothing are black.
typedef struct Receivers_16 {
    Points_16 points;
    Origins_16 from;
    uint16 x, y;  // pixels
    int16 valid;
} Receivers_16;

// Sets a field of some lanes, of all at first.
#define SET_LANES(field, value) \
    p->field = left == 0xffffu ? (float16)(value) : select(p->field, (float16)(value), lanes)
// What the lanes' materials have; most often they share one.
static void load_materials_16(__global const Material* materials, uint16 indices, Points_16* p) {
    int16 todo = (int16)(-1);
    for (uint left = 0xffffu; left; left = lanes_16(todo)) {
        const uint index = UINT_LANE(indices, lowest(left));
        const int16 lanes = indices == index;
        todo &= ~lanes;
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

static Receivers_16 load_receivers_16(Tiles tiles, Pass pass, uint group, Camera camera,
                                      __global const Surface* surfaces,
                                      __global const Material* materials) {
    const float16 zero = (float16)(0.0f), one = (float16)(1.0f);
    float16 rows[16];
    for (uint cell = 0u; cell < 16u; ++cell) {
        const uint item = pass_item(pass, 16u * group + cell);
        rows[cell] = vload16(0, (__global const float*)(surfaces + item));
    }
    transpose_16(rows);
    Receivers_16 r;
    const uint2 corner = item_pixel(tiles, pass_item(pass, 16u * group));
    r.x = corner.x + (uint16)(0, 4, 0, 4, 8, 12, 8, 12, 0, 4, 0, 4, 8, 12, 8, 12);
    r.y = corner.y + (uint16)(0, 0, 4, 4, 0, 0, 4, 4, 8, 8, 12, 12, 8, 8, 12, 12);
    r.valid = as_int16((r.x < tiles.width) & (r.y < tiles.height)) & (rows[3] >= 0.0f);
    r.points.px = select(one, rows[0], r.valid);
    r.points.py = select(one, rows[1], r.valid);
    r.points.pz = select(one, rows[2], r.valid);
    r.points.nx = select(one, rows[4], r.valid);
    r.points.ny = select(one, rows[5], r.valid);
    r.points.nz = select(one, rows[6], r.valid);
    r.from.gx = select(one, rows[8], r.valid);
    r.from.gy = select(one, rows[9], r.valid);
    r.from.gz = select(one, rows[10], r.valid);
    const float16 offset = select(zero, rows[11], r.valid);
    r.from.x = r.points.px + r.from.gx * offset;
    r.from.y = r.points.py + r.from.gy * offset;
    r.from.z = r.points.pz + r.from.gz * offset;
    r.from.reflects = zero;
    load_materials_16(materials, select((uint16)(0u), as_uint16(rows[15]), as_uint16(r.valid)),
                      &r.points);
    r.points.red = select(zero, r.points.red, r.valid);
    r.points.green = select(zero, r.points.green, r.valid);
    r.points.blue = select(zero, r.points.blue, r.valid);
#if HAS_GGX
    Points_16* p = &r.points;
    p->metallic = select(zero, p->metallic, r.valid);
    p->specular = select(zero, p->specular, r.valid);
    const int16 shiny = (p->metallic > 0.0f) | (p->specular > 0.0f);
    p->glossy = lanes_16(shiny) != 0u;
    p->vx = (float16)(-camera.forward.x);
    p->vy = (float16)(-camera.forward.y);
    p->vz = (float16)(-camera.forward.z);
    if (camera.forward.w == 0.0f) {
        p->vx = camera.origin.x - p->px;
        p->vy = camera.origin.y - p->py;
        p->vz = camera.origin.z - p->pz;
        const float16 squared = dot3_16(p->vx, p->vy, p->vz, p->vx, p->vy, p->vz);
        const float16 inverse = inverse_root_16(max(squared, 1e-30f));
        p->vx *= inverse;
        p->vy *= inverse;
        p->vz *= inverse;
    }
#if HAS_REFLECTIONS
    const float16 out = dot3_16(p->nx, p->ny, p->nz, p->vx, p->vy, p->vz);
    r.from.reflects =
        select(zero, one, shiny & (p->alpha < REFLECTING_ALPHA) & (out > LEAST_COSINE));
#endif
#endif
    return r;
}

#define PERMUTE(field) p.field = permute_16(all->field, lanes)
// The points of other lanes.
static Points_16 permute_points(const Points_16* all, uint16 lanes) {
    Points_16 p;
    PERMUTE(px);
    PERMUTE(py);
    PERMUTE(pz);
    PERMUTE(nx);
    PERMUTE(ny);
    PERMUTE(nz);
    PERMUTE(red);
    PERMUTE(green);
    PERMUTE(blue);
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

static Origins_16 permute_origins(const Origins_16* all, uint16 lanes) {
    Origins_16 p;
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

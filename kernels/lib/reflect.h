// SPDX-License-Identifier: MIT
// Surface points and what they reflect. Included by lib/node_estimate.h, which says what REAL and
// NAMED are: for one point and for LANES points.

// Surface points, by coordinates.
typedef struct NAMED(Points) {
    REAL px, py, pz;        // positions
    REAL nx, ny, nz;        // unit shading normals
    REAL red, green, blue;  // base colours
#if HAS_OUTGOING
    REAL through_red, through_green, through_blue;  // throughput
#endif
#if HAS_GGX
    REAL vx, vy, vz;  // unit, where their light goes
    REAL metallic, alpha, specular;
#if HAS_REFLECTANCE
    REAL f0_red, f0_green, f0_blue;  // Material::reflectance
#endif
    bool glossy;  // whether any of them has a lobe
#endif
} NAMED(Points);

typedef struct NAMED(Color) {
    REAL red, green, blue;
} NAMED(Color);

INLINE REAL NAMED(dot3)(REAL ax, REAL ay, REAL az, REAL bx, REAL by, REAL bz) {
    return fma(ax, bx, fma(ay, by, az * bz));
}

// 1 - the cosine of the angle of two unit vectors, whose cosine it is.
INLINE REAL NAMED(versine)(REAL cosine, REAL ax, REAL ay, REAL az, REAL bx, REAL by, REAL bz) {
    const REAL x = fma(ay, bz, -az * by), y = fma(az, bx, -ax * bz), z = fma(ax, by, -ay * bx);
    return WHERE(cosine > 0.0f, NAMED(dot3)(x, y, z, x, y, z) * NAMED(inverse)(1.0f + fabs(cosine)),
                 1.0f - cosine);
}

// (k + sqrt(k^2 + v)) / 2: max(k, 0), smoothed over sqrt(v); positive where v is, whatever the
// rounding.
INLINE REAL NAMED(soft)(REAL k, REAL v) {
    const REAL t = 0.5f * (fabs(k) + NAMED(root)(fma(k, k, v)));
    return WHERE(k >= 0.0f, t, 0.25f * v * NAMED(inverse)(max(t, (REAL)(1e-30f))));
}

#define FOR_POINTS 1
#include "material/ggx.h"
#include "material/lambert.h"
#undef FOR_POINTS

// Radiance reflected per illuminance from unit directions w: glTF's BRDF (lib/brdf.h) with a lobe
// that is widened by the lights' squared angular spread, times cosines and all else in `factor`.
// What stage reflections has of a light of `solid_angle` is left to it.
INLINE NAMED(Color) NAMED(reflect_all)(const NAMED(Points) * p, REAL wx, REAL wy, REAL wz,
                                       REAL spread, REAL solid_angle, REAL factor) {
#if HAS_GGX
    if (p->glossy) {
        NAMED(Color) c;
        REAL fresnel;
        const REAL lobe = NAMED(ggx)(p, wx, wy, wz, spread, solid_angle, &fresnel);
#if HAS_REFLECTANCE
        const REAL red = p->specular * fma(1.0f - p->f0_red, fresnel, p->f0_red);
        const REAL green = p->specular * fma(1.0f - p->f0_green, fresnel, p->f0_green);
        const REAL blue = p->specular * fma(1.0f - p->f0_blue, fresnel, p->f0_blue);
        const REAL ks = (1.0f - p->metallic) * lobe;
        const REAL metal = p->metallic * lobe * fresnel;
        const REAL base = (1.0f - p->metallic) * (1.0f - max(max(red, green), blue)) * M_1_PI_F +
                          p->metallic * lobe * (1.0f - fresnel);
        c.red = factor * (fma(p->red, base, metal) + ks * red);
        c.green = factor * (fma(p->green, base, metal) + ks * green);
        c.blue = factor * (fma(p->blue, base, metal) + ks * blue);
        return c;
#else
        const REAL dielectric = p->specular * fma((REAL)(0.96f), fresnel, (REAL)(0.04f));
        const REAL kd = (1.0f - p->metallic) * (1.0f - dielectric) * M_1_PI_F;
        const REAL ks = (1.0f - p->metallic) * dielectric * lobe + p->metallic * lobe * fresnel;
        const REAL base = kd + p->metallic * lobe * (1.0f - fresnel);
        c.red = factor * fma(p->red, base, ks);
        c.green = factor * fma(p->green, base, ks);
        c.blue = factor * fma(p->blue, base, ks);
        return c;
#endif
    }
#endif
    return NAMED(lambert)(p, factor);
}

// The same times the throughput.
INLINE NAMED(Color) NAMED(reflect)(const NAMED(Points) * p, REAL wx, REAL wy, REAL wz, REAL spread,
                                   REAL solid_angle, REAL factor) {
    NAMED(Color) c = NAMED(reflect_all)(p, wx, wy, wz, spread, solid_angle, factor);
#if HAS_OUTGOING
    c.red *= p->through_red;
    c.green *= p->through_green;
    c.blue *= p->through_blue;
#endif
    return c;
}

INLINE REAL NAMED(color_luminance)(NAMED(Color) c) {
    return 0.2126f * c.red + 0.7152f * c.green + 0.0722f * c.blue;
}

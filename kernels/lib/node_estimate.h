// SPDX-License-Identifier: MIT
// What a light tree's node contributes to surface points if nothing is in between: an estimate,
// exact for a single point light, positive wherever a contribution is possible.
//
// Included once with LANES 1, for one point, and once with LANES 16, for 16 points: names end in
// _1 and _16.
#if LANES == 1
#define REAL float
#define NAMED(name) name##_1
#define WHERE(condition, yes, no) ((condition) ? (yes) : (no))
#else
#define REAL float16
#define NAMED(name) name##_16
#define WHERE(condition, yes, no) select(no, yes, condition)
#endif

// Surface points, by coordinates.
typedef struct NAMED(Points) {
    REAL px, py, pz;        // positions
    REAL nx, ny, nz;        // unit shading normals
    REAL red, green, blue;  // base colours
#if HAS_GGX
    REAL vx, vy, vz;  // unit, to the camera
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

static REAL NAMED(dot3)(REAL ax, REAL ay, REAL az, REAL bx, REAL by, REAL bz) {
    return fma(ax, bx, fma(ay, by, az * bz));
}

// (k + sqrt(k^2 + v)) / 2: max(k, 0), smoothed over sqrt(v); positive where v is, whatever the
// rounding.
static REAL NAMED(soft)(REAL k, REAL v) {
    const REAL t = 0.5f * (fabs(k) + sqrt(fma(k, k, v)));
    return WHERE(k >= 0.0f, t, 0.25f * v / max(t, (REAL)(1e-30f)));
}

// The lights' part: their intensity's factor and the unit direction to their centre. 0 where none
// of them can be above the surface.
static REAL NAMED(node_geometry)(__global const LightNode* node, __global const Light* lights,
                                 const NAMED(Points) * p, REAL* wx, REAL* wy, REAL* wz,
                                 REAL* spread) {
    const float3 c = node->centre.xyz;
#if HAS_DIRECTIONAL
    if (node->infinite) {
        const float length2 = dot(c, c);
        const float3 towards = c * (1.0f / sqrt(max(length2, 1e-30f)));
        *wx = (REAL)(towards.x);
        *wy = (REAL)(towards.y);
        *wz = (REAL)(towards.z);
        *spread = (REAL)(node->centre.w);
        const REAL k = NAMED(dot3)(p->nx, p->ny, p->nz, *wx, *wy, *wz);
        return WHERE(k + node->intensity.w <= 0.0f, (REAL)(0.0f), NAMED(soft)(k, *spread));
    }
#endif
    const REAL dx = c.x - p->px, dy = c.y - p->py, dz = c.z - p->pz;
    const REAL distance2 = NAMED(dot3)(dx, dy, dz, dx, dy, dz);
    const REAL inverse = 1.0f / sqrt(max(distance2, (REAL)(1e-30f)));
    *wx = dx * inverse;
    *wy = dy * inverse;
    *wz = dz * inverse;
    const REAL softened = 1.0f / max(distance2 + node->centre.w, (REAL)(1e-30f));  // 1 / e^2
    *spread = node->centre.w * softened;
    const REAL k = NAMED(dot3)(p->nx, p->ny, p->nz, *wx, *wy, *wz);
    const REAL incidence = NAMED(soft)(k, *spread) * softened;
    REAL emission = (REAL)(1.0f);
    const float3 a = node->axis.xyz;
    const REAL along = -NAMED(dot3)((REAL)(a.x), (REAL)(a.y), (REAL)(a.z), *wx, *wy, *wz);
    switch (node->kind) {
#if HAS_POINT || HAS_SPOT
        case LIGHT_POINT:
        case LIGHT_SPOT: {
            __global const Light* light = lights + node->first;
            const float range = light->axis.w;
            if (range > 0.0f) {
                const REAL ratio = distance2 * (1.0f / (range * range));
                emission = clamp(1.0f - ratio * ratio, 0.0f, 1.0f);
            }
            if (node->kind == LIGHT_SPOT) {
                const REAL cone = clamp(along * light->edge.x + light->edge.y, 0.0f, 1.0f);
                emission *= cone * cone;
            }
            break;
        }
#endif
#if HAS_TRIANGLE || HAS_QUAD
        case LIGHT_QUAD:
        case LIGHT_TRIANGLE: {
            // The height over the emitter's plane: the same, whichever of its points is seen.
            REAL height = along * distance2 * inverse;
            if (node->axis.w > 0.0f) {  // two sides
                __global const Light* light = lights + node->first;
                const float3 n = normalize(cross(light->axis.xyz, light->edge.xyz));
                height = fabs(NAMED(dot3)(dx, dy, dz, (REAL)(n.x), (REAL)(n.y), (REAL)(n.z)));
            }
            emission = max(height, (REAL)(0.0f)) * sqrt(softened);
            break;
        }
#endif
        default: {
            const float iso = node->axis.w;
            const float o2 = (1.0f - iso) * (1.0f - iso);
            const float delta = max(o2 - dot(a, a), 0.0f) / 3.0f;
            emission = iso + (iso < 1.0f ? NAMED(soft)(along, *spread * o2 + delta) : (REAL)(0.0f));
        }
    }
    return WHERE(k + node->intensity.w * inverse <= 0.0f, (REAL)(0.0f), incidence * emission);
}

// Radiance reflected to the camera per illuminance from unit directions w: glTF's BRDF (lib/brdf.h)
// with a lobe that is widened by the lights' squared angular spread, times cosines and all else in
// `factor`.
static NAMED(Color) NAMED(reflect)(const NAMED(Points) * p, REAL wx, REAL wy, REAL wz, REAL spread,
                                   REAL factor, float3 intensity) {
    NAMED(Color) c;
#if HAS_GGX
    if (p->glossy) {
        REAL hx = wx + p->vx, hy = wy + p->vy, hz = wz + p->vz;
        const REAL scale = 1.0f / sqrt(max(NAMED(dot3)(hx, hy, hz, hx, hy, hz), (REAL)(1e-30f)));
        hx *= scale;
        hy *= scale;
        hz *= scale;
        const REAL a2 = fma(p->alpha, p->alpha, 0.25f * spread);
        const REAL n_h = NAMED(dot3)(p->nx, p->ny, p->nz, hx, hy, hz);
        const REAL n_in = max(NAMED(dot3)(p->nx, p->ny, p->nz, wx, wy, wz), (REAL)(0.0f));
        const REAL n_out =
            max(fabs(NAMED(dot3)(p->nx, p->ny, p->nz, p->vx, p->vy, p->vz)), (REAL)(1e-4f));
        // 1 - (N.H)^2 would cancel for small alpha.
        const REAL sx = fma(p->ny, hz, -p->nz * hy);
        const REAL sy = fma(p->nz, hx, -p->nx * hz);
        const REAL sz = fma(p->nx, hy, -p->ny * hx);
        const REAL width = fma(a2 * n_h, n_h, NAMED(dot3)(sx, sy, sz, sx, sy, sz));
        const REAL smith = (n_in + sqrt(fma(1.0f - a2, n_in * n_in, a2))) *
                           (n_out + sqrt(fma(1.0f - a2, n_out * n_out, a2)));
        const REAL lobe = a2 / (M_PI_F * width * width * smith);
        const REAL m = max(1.0f - fabs(NAMED(dot3)(p->vx, p->vy, p->vz, hx, hy, hz)), (REAL)(0.0f));
        const REAL fresnel = (m * m) * (m * m) * m;
#if HAS_REFLECTANCE
        const REAL red = p->specular * fma(1.0f - p->f0_red, fresnel, p->f0_red);
        const REAL green = p->specular * fma(1.0f - p->f0_green, fresnel, p->f0_green);
        const REAL blue = p->specular * fma(1.0f - p->f0_blue, fresnel, p->f0_blue);
        const REAL ks = (1.0f - p->metallic) * lobe;
        const REAL metal = p->metallic * lobe * fresnel;
        const REAL base = (1.0f - p->metallic) * (1.0f - max(max(red, green), blue)) * M_1_PI_F +
                          p->metallic * lobe * (1.0f - fresnel);
        c.red = factor * intensity.x * (fma(p->red, base, metal) + ks * red);
        c.green = factor * intensity.y * (fma(p->green, base, metal) + ks * green);
        c.blue = factor * intensity.z * (fma(p->blue, base, metal) + ks * blue);
        return c;
#else
        const REAL dielectric = p->specular * fma((REAL)(0.96f), fresnel, (REAL)(0.04f));
        const REAL kd = (1.0f - p->metallic) * (1.0f - dielectric) * M_1_PI_F;
        const REAL ks = (1.0f - p->metallic) * dielectric * lobe + p->metallic * lobe * fresnel;
        const REAL base = kd + p->metallic * lobe * (1.0f - fresnel);
        c.red = factor * intensity.x * fma(p->red, base, ks);
        c.green = factor * intensity.y * fma(p->green, base, ks);
        c.blue = factor * intensity.z * fma(p->blue, base, ks);
        return c;
#endif
    }
#endif
    factor *= M_1_PI_F;
    c.red = factor * intensity.x * p->red;
    c.green = factor * intensity.y * p->green;
    c.blue = factor * intensity.z * p->blue;
    return c;
}

// The node's radiance reflected to the camera, cd/m2: intensity x geometry x BRDF towards the
// centre.
static NAMED(Color) NAMED(node_estimate)(__global const LightNode* node,
                                         __global const Light* lights, const NAMED(Points) * p) {
    REAL wx, wy, wz, spread;
    const REAL geometry = NAMED(node_geometry)(node, lights, p, &wx, &wy, &wz, &spread);
    return NAMED(reflect)(p, wx, wy, wz, spread, geometry, node->intensity.xyz);
}

static REAL NAMED(color_luminance)(NAMED(Color) c) {
    return 0.2126f * c.red + 0.7152f * c.green + 0.0722f * c.blue;
}

#undef REAL
#undef NAMED
#undef WHERE

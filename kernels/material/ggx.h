// SPDX-License-Identifier: MIT
// The GGX lobe of glTF's material (appendix B of glTF 2.0). Included once for every use, which it
// compiles alone: FOR_RECEIVER 1: of one receiver (lib/brdf.h); FOR_POINTS 1: of points by
// coordinates, for a node of the light tree, too (lib/reflect.h).

#if FOR_RECEIVER && HAS_GGX
// D V of appendix B: the microfacet distribution times Smith's visibility / (4 N.L N.V).
// 1 - (N.H)^2 is taken from the cross product: it would cancel for small alpha. Inlined whatever
// the compiler thinks: where Intel's runtime (2026.22) called it in a kernel of 16 work-items at
// once, single ones got infinity.
__attribute__((always_inline)) static inline float ggx_lobe(float alpha, float3 n, float3 h,
                                                            float n_in, float n_out) {
    const float a2 = alpha * alpha;
    const float3 sine = cross(n, h);
    const float n_h = dot(n, h);
    const float width = dot(sine, sine) + a2 * n_h * n_h;
    const float in = n_in + sqrt(a2 + (1.0f - a2) * n_in * n_in);
    const float out = n_out + sqrt(a2 + (1.0f - a2) * n_out * n_out);
    return a2 / (M_PI_F * width * width * in * out);
}

static float schlick(float cosine) {
    const float m = max(1.0f - cosine, 0.0f);
    return (m * m) * (m * m) * m;
}

// Fresnel's terms, where schlick() is s.
#if HAS_REFLECTANCE
typedef float3 Fresnel;
static Fresnel dielectric_fresnel(Material m, float s) {
    return m.specular * (m.reflectance.xyz + (1.0f - m.reflectance.xyz) * s);
}
// What the diffuse base below does not get.
static float taken(Fresnel f) { return max(max(f.x, f.y), f.z); }
#else
typedef float Fresnel;
static Fresnel dielectric_fresnel(Material m, float s) { return m.specular * (0.04f + 0.96f * s); }
static float taken(Fresnel f) { return f; }
#endif

static float3 metal_fresnel(Material m, float s) {
    return m.base_color.xyz + (1.0f - m.base_color.xyz) * s;
}

#if HAS_REFLECTIONS
// The density, 1/sr, of the directions that stage reflections draws, where the lobe has the value
// of ggx_lobe(): G1(wo) D / (4 N.V).
static float lobe_density(float lobe, float alpha, float n_in) {
    const float a2 = alpha * alpha;
    return 0.5f * lobe * (n_in + sqrt(a2 + (1.0f - a2) * n_in * n_in));
}

// The light samples' share of what the lobe reflects of a point of a light's cell; stage
// reflections has the rest. Veach's power heuristic for one light sample on the cell, which seen
// from the surface has `solid_angle`, and one direction of the lobe; for n light samples it is that
// of solid_angle / n.
static float light_share(float density, float solid_angle) {
    const float ratio = density * solid_angle;
    return 1.0f / (1.0f + ratio * ratio);
}

// 1 - light_share(), without its cancellation.
static float lobe_share(float density, float solid_angle) {
    const float ratio = density * solid_angle;
    return ratio * ratio * light_share(density, solid_angle);
}

// Unit vectors that make a right-handed frame with unit vector n (Duff et al., "Building an
// Orthonormal Basis, Revisited", JCGT 6:1, 2017).
static void make_frame(float3 n, float3* tangent, float3* bitangent) {
    const float sign = copysign(1.0f, n.z);
    const float a = -1.0f / (sign + n.z);
    const float b = n.x * n.y * a;
    *tangent = (float3)(1.0f + sign * n.x * n.x * a, sign * b, -sign * n.x);
    *bitangent = (float3)(b, sign + n.y * n.y * a, -n.y);
}

// A direction of the lobe's light, unit, with density lobe_density(): wo mirrored at a normal that
// is drawn from those of the microfacets that wo sees (Heitz, "Sampling the GGX Distribution of
// Visible Normals", JCGT 7:4, 2018), as a point of a spherical cap (Dupuy and Benyoub, "Sampling
// Visible GGX Normals with Spherical Caps", 2023).
static float3 sample_lobe(float alpha, float3 n, float3 wo, float2 u) {
    float3 x, y;
    make_frame(n, &x, &y);
    const float3 stretched =
        normalize((float3)(alpha * dot(wo, x), alpha * dot(wo, y), dot(wo, n)));
    const float z = (1.0f - u.y) * (1.0f + stretched.z) - stretched.z;
    const float sine = sqrt(max(1.0f - z * z, 0.0f));
    const float phi = 2.0f * M_PI_F * u.x;
    const float3 cap = stretched + (float3)(sine * cos(phi), sine * sin(phi), z);
    const float3 h = normalize(x * (alpha * cap.x) + y * (alpha * cap.y) + n * cap.z);
    return normalize(h * (2.0f * dot(wo, h)) - wo);
}
#endif
#endif

#if FOR_POINTS && HAS_GGX
// The lobe of lib/reflect.h's points, widened by the squared angular spread of the lights in unit
// direction w, 1/sr, less what stage reflections has of a light of `solid_angle`; `fresnel` gets
// schlick(). Not the text above with other types: that divides and takes roots as OpenCL rounds
// them, this by lib/inverse.h.
INLINE REAL NAMED(ggx)(const NAMED(Points) * p, REAL wx, REAL wy, REAL wz, REAL spread,
                       REAL solid_angle, REAL* fresnel) {
    REAL hx = wx + p->vx, hy = wy + p->vy, hz = wz + p->vz;
    const REAL scale =
        NAMED(inverse_root)(max(NAMED(dot3)(hx, hy, hz, hx, hy, hz), (REAL)(1e-30f)));
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
    const REAL in = n_in + NAMED(root)(fma(1.0f - a2, n_in * n_in, a2));
    const REAL out = n_out + NAMED(root)(fma(1.0f - a2, n_out * n_out, a2));
    const REAL across = NAMED(inverse)(max(width, 0.5f * a2));  // w = -v: no h
    REAL lobe = M_1_PI_F * a2 * across * across * NAMED(inverse)(in * out);
#if HAS_REFLECTIONS
    const REAL ratio = 0.5f * lobe * in * solid_angle;  // light_share()
    lobe *= NAMED(inverse)(fma(ratio, ratio, (REAL)(1.0f)));
#endif
    const REAL m = max(1.0f - fabs(NAMED(dot3)(p->vx, p->vy, p->vz, hx, hy, hz)), (REAL)(0.0f));
    *fresnel = (m * m) * (m * m) * m;
    return lobe;
}
#endif

// SPDX-License-Identifier: MIT
// glTF 2.0's material, appendix B of its specification: Lambert, and GGX where HAS_GGX.
#ifndef MANYLIGHT_LIB_BRDF_H
#define MANYLIGHT_LIB_BRDF_H

#include "lib/common.h"
#include "shared/material.h"

// The least cosine to the viewer that the GGX lobe is evaluated for.
#define LEAST_COSINE 1e-4f

#if HAS_GGX
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
#endif

#if HAS_REFLECTIONS && HAS_GGX
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
#endif

// The BRDF, 1/sr, between unit directions away from the surface, with unit shading normal n;
// 0 where wi is below it. Of the GGX lobe only light_share() of `solid_angle`.
static float3 brdf(Material m, float3 n, float3 wi, float3 wo, float solid_angle) {
    const float n_in = dot(n, wi);
    if (n_in <= 0.0f) return (float3)(0.0f);
    const float3 diffuse = m.base_color.xyz * M_1_PI_F;
#if HAS_GGX
    const float metallic = m.base_color.w;
    if (metallic == 0.0f && m.specular == 0.0f) return diffuse;
    const float n_out = max(fabs(dot(n, wo)), LEAST_COSINE);
    const float3 h = normalize(wi + wo);
    float lobe = ggx_lobe(m.roughness, n, h, n_in, n_out);
#if HAS_REFLECTIONS
    lobe *= light_share(lobe_density(lobe, m.roughness, n_in), solid_angle);
#endif
    const float s = schlick(dot(wo, h));
    const Fresnel dielectric = dielectric_fresnel(m, s);
    const float3 metal = metal_fresnel(m, s);
    return (1.0f - metallic) * (diffuse * (1.0f - taken(dielectric)) + lobe * dielectric) +
           metallic * lobe * metal;
#else
    return diffuse;
#endif
}

#endif

// SPDX-License-Identifier: MIT
// glTF 2.0's material, appendix B of its specification: Lambert's lobe, and GGX where HAS_GGX.
#ifndef MANYLIGHT_LIB_BRDF_H
#define MANYLIGHT_LIB_BRDF_H

#include "lib/common.h"
#include "shared/material.h"

// The least cosine to the viewer that the GGX lobe is evaluated for.
#define LEAST_COSINE 1e-4f

#define FOR_RECEIVER 1
#include "material/ggx.h"
#include "material/lambert.h"
#undef FOR_RECEIVER

// The BRDF, 1/sr, between unit directions away from the surface, with unit shading normal n;
// 0 where wi is below it. Of the GGX lobe only light_share() of `solid_angle`.
static float3 brdf(Material m, float3 n, float3 wi, float3 wo, float solid_angle) {
    const float n_in = dot(n, wi);
    if (n_in <= 0.0f) return (float3)(0.0f);
    const float3 diffuse = lambert(m);
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

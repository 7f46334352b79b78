// SPDX-License-Identifier: MIT
// glTF 2.0's material, appendix B of its specification: Lambert, and GGX where HAS_GGX.
#ifndef MANYLIGHT_LIB_BRDF_H
#define MANYLIGHT_LIB_BRDF_H

#include "lib/common.h"
#include "shared/material.h"

#if HAS_GGX
// D V of appendix B: the microfacet distribution times Smith's visibility / (4 N.L N.V).
// 1 - (N.H)^2 is taken from the cross product: it would cancel for small alpha.
static float ggx_lobe(float alpha, float3 n, float3 h, float n_in, float n_out) {
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
#endif

// The BRDF, 1/sr, between unit directions away from the surface, with unit shading normal n;
// 0 where wi is below it.
static float3 brdf(Material m, float3 n, float3 wi, float3 wo) {
    const float n_in = dot(n, wi);
    if (n_in <= 0.0f) return (float3)(0.0f);
    const float3 diffuse = m.base_color.xyz * M_1_PI_F;
#if HAS_GGX
    const float metallic = m.base_color.w;
    const float n_out = max(fabs(dot(n, wo)), 1e-4f);
    const float3 h = normalize(wi + wo);
    const float lobe = ggx_lobe(m.roughness, n, h, n_in, n_out);
    const float s = schlick(dot(wo, h));
    const float dielectric = m.specular * (0.04f + 0.96f * s);
    const float3 metal = m.base_color.xyz + (1.0f - m.base_color.xyz) * s;
    return (1.0f - metallic) * (diffuse * (1.0f - dielectric) + lobe * dielectric) +
           metallic * lobe * metal;
#else
    return diffuse;
#endif
}

#endif

// SPDX-License-Identifier: MIT
// Stage reflections: area lights as glossy surfaces reflect them, by one ray per pixel sample that
// is drawn from the GGX lobe. It shares the lobe's light with the light samples by the power
// heuristic (multiple importance sampling: Veach and Guibas, "Optimally Combining Sampling
// Techniques for Monte Carlo Rendering", 1995); see lobe_share() in
// material/ggx.h.
#include "lib/direct.h"
#include "lib/random.h"
#include "lib/textures.h"
#include "lib/tiles.h"

#if HAS_REFLECTIONS && HAS_GGX

#if HAS_TEXTURES
#define MAP_PARAMETERS , TEXTURE_PARAMETERS
#else
#define MAP_PARAMETERS
#endif

// Adds to estimates[item].rgb, cd/m2. cell_areas[triangle]: see Scene.
KERNEL void reflections_add(Tiles tiles, VIEW_PARAMETERS, BVH_PARAMETERS,
                            __global const float* vertices, __global const uint* indices,
                            __global const uint* triangle_materials,
                            __global const Material* materials, __global const float* cell_areas,
                            __global const Surface* surfaces, uint pixel_sample, uint seed,
                            __global float4* estimates MAP_PARAMETERS) {
    const uint item = get_global_id(0);
    if (!item_in_image(tiles, item) || surface_missed(surfaces + item)) return;
    const Receiver r = make_receiver(surfaces, item, materials, VIEW);
    if (!r.reflects) return;
    const uint2 pixel = item_pixel(tiles, item);
    const float2 u = reflection_point(pixel.y * tiles.width + pixel.x, pixel_sample, seed);
    const float3 wi = sample_lobe(r.material.roughness, r.normal, r.outgoing, u);
    if (dot(r.normal, wi) <= 0.0f || dot(r.horizon, wi) <= 0.0f) return;
    const Ray ray = {shadow_origin(&r), wi, INFINITY};
    const Hit hit = closest_hit(BVH_ARGUMENTS, ray, 0.0f);
#if HAS_INSTANCES
    if (hit.triangle >= bvh_instances[0].first) return;  // no light is of one
#endif
    const float area = hit.triangle == ~0u ? 0.0f : cell_areas[hit.triangle];
    if (area == 0.0f) return;
    const uint3 corner = vload3(hit.triangle, indices);
    const float3 v0 = vload3(corner.x, vertices);
    const float3 edge1 = vload3(corner.y, vertices) - v0;
    const float3 edge2 = vload3(corner.z, vertices) - v0;
    const float3 face = cross(edge1, edge2);
    const float cosine = -dot(wi, normalize(face));
    float4 emission = materials[triangle_materials[hit.triangle]].emission;
    if (cosine < 0.0f && emission.w == 0.0f) return;
#if HAS_TEXTURES
    emission.xyz *= sample_map(TEXTURE_ARGUMENTS,
                               MAP_KIND_COUNT * triangle_materials[hit.triangle] + MAP_EMISSION,
                               corner, hit_weights(ray, v0, edge1, edge2), 0.0f)
                        .xyz;
#endif
    const float solid_angle = area * fabs(cosine) / (hit.t * hit.t);
    const Material m = r.material;
    const float n_in = dot(r.normal, wi);
    const float3 h = normalize(wi + r.outgoing);
    const float lobe = ggx_lobe(m.roughness, r.normal, h, n_in, dot(r.normal, r.outgoing));
    const float density = lobe_density(lobe, m.roughness, n_in);
    const float s = schlick(dot(r.outgoing, h));
    const float3 fresnel =
        (1.0f - m.base_color.w) * dielectric_fresnel(m, s) + m.base_color.w * metal_fresnel(m, s);
    const float share = lobe_share(density, solid_angle);
    const float3 value = fresnel * (lobe * n_in / density * share) * emission.xyz;
#if HAS_OUTGOING
    estimates[item].xyz += value * r.throughput;
#else
    estimates[item].xyz += value;
#endif
}

#endif

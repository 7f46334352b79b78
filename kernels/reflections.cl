// SPDX-License-Identifier: MIT
// Stage reflections: area lights as glossy surfaces reflect them, by one ray per pixel sample that
// is drawn from the GGX lobe. It shares the lobe's light with the light samples by the power
// heuristic (multiple importance sampling: Veach and Guibas, "Optimally Combining Sampling
// Techniques for Monte Carlo Rendering", 1995); see lobe_share() in material/ggx.h, and
// lib/reflected.h, which adds what is found here.
#include "lib/direct.h"
#include "lib/random.h"
#include "lib/textures.h"
#include "lib/tiles.h"
#include "lights/cells.h"
#include "shared/reflected.h"

#if HAS_REFLECTIONS && HAS_GGX

#if HAS_TEXTURES
#define MAP_PARAMETERS , TEXTURE_PARAMETERS
#else
#define MAP_PARAMETERS
#endif

// Fills reflected[item] of the items that hit the scene. grid_of[triangle], grids, cell_lights: see
// LightCells in host/scene/scene.hpp.
KERNEL void reflections_trace(Tiles tiles, VIEW_PARAMETERS, BVH_PARAMETERS,
                              __global const float* vertices, __global const uint* indices,
                              __global const uint* triangle_materials,
                              __global const Material* materials, __global const uint* grid_of,
                              __global const CellGrid* grids, __global const uint* cell_lights,
                              __global const Surface* surfaces, uint pixel_sample, uint seed,
                              __global Reflected* reflected MAP_PARAMETERS) {
    const uint item = get_global_id(0);
    if (!item_in_image(tiles, item) || surface_missed(surfaces + item)) return;
    reflected[item].emission.w = 0.0f;
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
    const uint grid = hit.triangle == ~0u ? NO_GRID : grid_of[hit.triangle];
    if (grid == NO_GRID) return;
    const uint3 corner = vload3(hit.triangle, indices);
    const float3 v0 = vload3(corner.x, vertices);
    const float3 edge1 = vload3(corner.y, vertices) - v0;
    const float3 edge2 = vload3(corner.z, vertices) - v0;
    const float3 face = cross(edge1, edge2);
    const float cosine = -dot(wi, normalize(face));
    float4 emission = materials[triangle_materials[hit.triangle]].emission;
    if (cosine < 0.0f && emission.w == 0.0f) return;
    const float2 weights = hit_weights(ray, v0, edge1, edge2);
#if HAS_TEXTURES
    emission.xyz *= sample_map(TEXTURE_ARGUMENTS,
                               MAP_KIND_COUNT * triangle_materials[hit.triangle] + MAP_EMISSION,
                               corner, weights, 0.0f)
                        .xyz;
#endif
    const float solid_angle = grids[grid].area * fabs(cosine) / (hit.t * hit.t);
    const Material m = r.material;
    const float n_in = dot(r.normal, wi);
    const float3 h = normalize(wi + r.outgoing);
    const float lobe = ggx_lobe(m.roughness, r.normal, h, n_in, dot(r.normal, r.outgoing));
    const float density = lobe_density(lobe, m.roughness, n_in);
    const float s = schlick(dot(r.outgoing, h));
    const float3 fresnel =
        (1.0f - m.base_color.w) * dielectric_fresnel(m, s) + m.base_color.w * metal_fresnel(m, s);
    reflected[item].emission = (float4)(emission.xyz, density * solid_angle);
    reflected[item].fresnel = (float4)(fresnel, lobe * n_in / density);
    reflected[item].light = cell_lights[grids[grid].first + cell_of(grids + grid, weights)];
}

#endif

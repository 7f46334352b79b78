// SPDX-License-Identifier: MIT
// Stage gbuffer: one primary ray per pixel of a run of tiles.
#include "lib/bvh.h"
#include "lib/random.h"
#include "lib/tiles.h"
#include "shared/camera.h"
#include "shared/surface.h"

static float largest_coordinate(float3 v) {
    const float3 a = fabs(v);
    return max(max(a.x, a.y), a.z);
}

// surfaces[item]; `jitter` 0 puts the ray through the pixel's centre.
KERNEL void gbuffer_trace(Tiles tiles, Camera camera, uint jitter, uint pixel_sample, uint seed,
                          BVH_PARAMETERS, __global const float* vertices,
#if HAS_SMOOTH
                          __global const float* vertex_normals,
#endif
                          __global const uint* indices, __global const uint* triangle_materials,
                          __global Surface* surfaces) {
    const uint item = get_global_id(0);
    if (!item_in_image(tiles, item)) return;
    const uint2 pixel = item_pixel(tiles, item);
    const float2 within = jitter
                              ? pixel_position(pixel.y * tiles.width + pixel.x, pixel_sample, seed)
                              : (float2)(0.5f);
    const float sx = 2.0f * ((float)pixel.x + within.x) / (float)tiles.width - 1.0f;
    const float sy = 1.0f - 2.0f * ((float)pixel.y + within.y) / (float)tiles.height;
    const float3 offset = camera.right.xyz * sx + camera.up.xyz * sy;
    const bool orthographic = camera.forward.w != 0.0f;
    Ray ray;
    ray.origin = orthographic ? camera.origin.xyz + offset : camera.origin.xyz;
    ray.direction = orthographic ? camera.forward.xyz : normalize(camera.forward.xyz + offset);
    ray.end = INFINITY;

    __global Surface* surface = surfaces + item;
    const Hit hit = closest_hit(BVH_ARGUMENTS, ray);
    if (hit.triangle == ~0u) {
        surface->position = (float4)(0.0f, 0.0f, 0.0f, -1.0f);
        return;
    }
    __global const uint* corner = indices + 3 * hit.triangle;
    const float3 v0 = vload3(corner[0], vertices);
    const float3 v1 = vload3(corner[1], vertices);
    const float3 v2 = vload3(corner[2], vertices);
    const float3 face = cross(v1 - v0, v2 - v0);
    const bool front = dot(face, ray.direction) < 0.0f;
    const float3 geometric = normalize(front ? face : -face);
    float3 normal = geometric;
#if HAS_SMOOTH
    const float3 smooth = vload3(corner[0], vertex_normals) * (1.0f - hit.u - hit.v) +
                          vload3(corner[1], vertex_normals) * hit.u +
                          vload3(corner[2], vertex_normals) * hit.v;
    if (dot(smooth, smooth) > 0.0f)
        normal = normalize(dot(smooth, geometric) < 0.0f ? -smooth : smooth);
#endif
    const float extent =
        max(max(largest_coordinate(v0), largest_coordinate(v1)), largest_coordinate(v2));
    surface->position = (float4)(v0 + (v1 - v0) * hit.u + (v2 - v0) * hit.v, hit.t);
    surface->normal = (float4)(normal, 0.0f);
    surface->geometric = (float4)(geometric, OFFSET_SCALE * extent);
    surface->triangle = hit.triangle;
    surface->material = triangle_materials[hit.triangle];
    surface->front = front ? 1u : 0u;
}

// SPDX-License-Identifier: MIT
// Stage gbuffer: one primary ray per pixel of a run of tiles.
#include "lib/packet.h"
#include "lib/random.h"
#include "lib/tiles.h"
#include "shared/camera.h"
#include "shared/surface.h"

#if HAS_SMOOTH
#define MESH_PARAMETERS                                                   \
    __global const float *vertices, __global const float *vertex_normals, \
        __global const uint *indices, __global const uint *triangle_materials
#define MESH_ARGUMENTS vertices, vertex_normals, indices, triangle_materials
#else
#define MESH_PARAMETERS                                           \
    __global const float *vertices, __global const uint *indices, \
        __global const uint *triangle_materials
#define MESH_ARGUMENTS vertices, indices, triangle_materials
#endif

// The primary ray of an item; `jitter` 0 puts it through the pixel's centre.
static Ray primary_ray(Tiles tiles, uint item, Camera camera, uint jitter, uint pixel_sample,
                       uint seed) {
    const uint2 pixel = item_pixel(tiles, item);
    const float2 within = jitter
                              ? pixel_position(pixel.y * tiles.width + pixel.x, pixel_sample, seed)
                              : (float2)(0.5f);
    const float sx = 2.0f * ((float)pixel.x + within.x) / (float)tiles.width - 1.0f;
    const float sy = 1.0f - 2.0f * ((float)pixel.y + within.y) / (float)tiles.height;
    const float3 offset = camera.right.xyz * sx + camera.up.xyz * sy;
    const bool orthographic = camera.forward.w != 0.0f;
    const Ray ray = {orthographic ? camera.origin.xyz + offset : camera.origin.xyz,
                     orthographic ? camera.forward.xyz : normalize(camera.forward.xyz + offset),
                     INFINITY};
    return ray;
}

// The surface where a ray hits a triangle; ~0: none.
static void write_surface(__global Surface* surface, Ray ray, uint triangle, float distance,
                          MESH_PARAMETERS) {
    if (triangle == ~0u) {
        surface->position = (float4)(0.0f, 0.0f, 0.0f, -1.0f);
        return;
    }
    __global const uint* corner = indices + 3 * triangle;
    const float3 v0 = vload3(corner[0], vertices);
    const float3 v1 = vload3(corner[1], vertices);
    const float3 v2 = vload3(corner[2], vertices);
    const float3 face = cross(v1 - v0, v2 - v0);
    const float2 weights = hit_weights(ray, v0, v1 - v0, v2 - v0);
    const bool front = dot(face, ray.direction) < 0.0f;
    const float3 geometric = normalize(front ? face : -face);
    float3 normal = geometric;
#if HAS_SMOOTH
    const float3 smooth = vload3(corner[0], vertex_normals) * (1.0f - weights.x - weights.y) +
                          vload3(corner[1], vertex_normals) * weights.x +
                          vload3(corner[2], vertex_normals) * weights.y;
    if (dot(smooth, smooth) > 0.0f)
        normal = normalize(dot(smooth, geometric) < 0.0f ? -smooth : smooth);
#endif
    const float extent = max(max(largest_part(v0), largest_part(v1)), largest_part(v2));
    surface->position = (float4)(v0 + (v1 - v0) * weights.x + (v2 - v0) * weights.y, distance);
    surface->normal = (float4)(normal, 0.0f);
    surface->geometric = (float4)(geometric, OFFSET_SCALE * extent);
    surface->triangle = triangle;
    surface->material = triangle_materials[triangle];
    surface->front = front ? 1u : 0u;
}

// surfaces[item], one item per work-item.
KERNEL void gbuffer_trace_rays(Tiles tiles, Camera camera, uint jitter, uint pixel_sample,
                               uint seed, BVH_PARAMETERS, MESH_PARAMETERS,
                               __global Surface* surfaces) {
    const uint item = get_global_id(0);
    if (!item_in_image(tiles, item)) return;
    const Ray ray = primary_ray(tiles, item, camera, jitter, pixel_sample, seed);
    const Hit hit = closest_hit(BVH_ARGUMENTS, ray);
    write_surface(surfaces + item, ray, hit.triangle, hit.t, MESH_ARGUMENTS);
}

// The same, 16 items (4 x 4 pixels) per work-item; for cameras whose rays have one origin.
KERNEL void gbuffer_trace_packets(Tiles tiles, Camera camera, uint jitter, uint pixel_sample,
                                  uint seed, BVH_PARAMETERS, MESH_PARAMETERS,
                                  __global Surface* surfaces) {
    const uint first = 16u * (uint)get_global_id(0);
    float16 x = (float16)(0.0f), y = x, z = x, end = x;
    for (uint lane = 0u; lane < 16u; ++lane) {
        if (!item_in_image(tiles, first + lane)) continue;
        const Ray ray = primary_ray(tiles, first + lane, camera, jitter, pixel_sample, seed);
        SET_LANE(x, lane, ray.direction.x);
        SET_LANE(y, lane, ray.direction.y);
        SET_LANE(z, lane, ray.direction.z);
        SET_LANE(end, lane, INFINITY);
    }
    Packet packet = make_packet(camera.origin.xyz, x, y, z, end);
    int16 triangles;
    closest_hits(BVH_ARGUMENTS, &packet, &triangles);
    for (uint lane = 0u; lane < 16u; ++lane) {
        if (!item_in_image(tiles, first + lane)) continue;
        const Ray ray = {packet.origin, direction_of(&packet, lane), INFINITY};
        write_surface(surfaces + first + lane, ray, (uint)INT_LANE(triangles, lane),
                      LANE(packet.end, lane), MESH_ARGUMENTS);
    }
}

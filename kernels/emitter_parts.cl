// SPDX-License-Identifier: MIT
// Stage emitter_parts: what the camera sees of emitters that cover a part of a pixel, from their
// own side. A pixel's rays meet a small one seldom, and find of an edge what chance has it; so the
// part that the pixel's square covers is known beforehand, and each pixel sample draws a point on
// it, to which a ray from the camera tells whether it is seen. Points drawn so are denser on the
// film than the pixel's rays, one to a pixel; they count alone, and what these meet there does not
// (the maximum heuristic of multiple importance sampling: Veach and Guibas 1995, see
// reflections.cl).
#include "lib/bvh.h"
#include "lib/film.h"
#include "lib/random.h"
#include "lib/textures.h"
#include "lib/tiles.h"
#include "shared/emitter_part.h"
#include "shared/material.h"
#include "shared/surface.h"

#if HAS_TEXTURES
#define MAP_PARAMETERS , TEXTURE_PARAMETERS
#else
#define MAP_PARAMETERS
#endif

// Of the parts, numbers first, first + stride, ... are drawn: each in every stride-th sample.
// light[t].rgb, cd/m2, is what the pixel of part first + stride t sees of it, times stride; of
// pixels of other tiles anything.
KERNEL void emitter_parts_draw(Tiles tiles, Camera camera, BVH_PARAMETERS,
                               __global const float* vertices, __global const uint* indices,
                               __global const uint* triangle_materials,
                               __global const Material* materials,
                               __global const EmitterPart* parts, uint part_count, uint first,
                               uint stride, uint pixel_sample, uint seed,
                               __global float4* light MAP_PARAMETERS) {
    const uint t = get_global_id(0);
    const ulong number = first + (ulong)stride * t;
    if (number >= part_count) return;
    const EmitterPart part = parts[number];
    const uint x = part.pixel % tiles.width, y = part.pixel / tiles.width;
    const uint tile = (y / tiles.size) * tiles.columns + x / tiles.size;
    if (tile - tiles.first >= tiles.count) return;
    light[t] = (float4)(0.0f);

    const uint3 index = vload3(part.triangle, indices);
    const float3 v0 = vload3(index.x, vertices);
    const float3 v1 = vload3(index.y, vertices), v2 = vload3(index.z, vertices);
    const uint4 bits = random_bits((uint)number, 0u, RANDOM_EMITTER, seed);
    float2 u = sobol_point(pixel_sample / stride, bits.xy);
    if (u.x + u.y > 1.0f) u = 1.0f - u;
    const float2 near = u * part.way_2.zw;
    const float2 weights = part.corner.xy + (part.corner.zw * near.x + part.way_2.xy * near.y) /
                                                (1.0f - u.x - u.y + near.x + near.y);
    const float3 position = v0 * (1.0f - weights.x - weights.y) + v1 * weights.x + v2 * weights.y;

    const float3 start = film_start(camera, position);
    const float3 face = cross(v1 - v0, v2 - v0);
    const float3 normal = normalize(dot(face, position - start) < 0.0f ? face : -face);
    const uint material = triangle_materials[part.triangle];
    float3 emission = materials[material].emission.xyz;
#if HAS_TEXTURES
    const float3 eye = camera.forward.w != 0.0f ? start : camera.origin.xyz;
    const float distance = length(position - eye);
    const float share =
        seen_area(tiles, camera, (position - eye) / distance, distance, normal) / length(face);
    emission *= sample_map(TEXTURE_ARGUMENTS, MAP_KIND_COUNT * material + MAP_EMISSION, index,
                           weights, share)
                    .xyz;
#endif
    // As shadow rays end off an emitter (OFFSET_SCALE).
    const float3 sizes = max(max(fabs(v0), fabs(v1)), fabs(v2));
    const float3 target = position + normal * (OFFSET_SCALE * dot(fabs(normal), sizes));
    const Ray ray = {start, target - start, 1.0f};
    if (occluded(BVH_ARGUMENTS, ray)) return;
    light[t].xyz = emission * (part.covered * (float)stride);
}

// seen[item].rgb: what the parts add to the pixel sample, cd/m2; .w: 0 where the ray of the pixel
// sample has met an emitter that parts of the pixel stand for, else 1. Those of pixel p are parts
// pixel_parts[p] to pixel_parts[p + 1].
KERNEL void emitter_parts_gather(Tiles tiles, __global const Surface* surfaces,
                                 __global const EmitterPart* parts,
                                 __global const uint* pixel_parts, uint first, uint stride,
                                 __global const float4* light, __global float4* seen) {
    const uint item = get_global_id(0);
    if (!item_in_image(tiles, item)) return;
    const uint2 at = item_pixel(tiles, item);
    const uint pixel = at.y * tiles.width + at.x;
    const uint met = surfaces[item].position.w < 0.0f ? ~0u : surfaces[item].triangle;
    float4 sum = (float4)(0.0f, 0.0f, 0.0f, 1.0f);
    for (uint k = pixel_parts[pixel]; k < pixel_parts[pixel + 1u]; ++k) {
        if (parts[k].triangle == met) sum.w = 0.0f;
        if (k % stride == first) sum.xyz += light[k / stride].xyz;
    }
    seen[item] = sum;
}

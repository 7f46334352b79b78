// SPDX-License-Identifier: MIT
// Stage gbuffer: one primary ray per pixel of a run of tiles.
#include "lib/film.h"
#include "lib/random.h"
#include "lib/textures.h"
#include "lib/tiles.h"
#include "lib/trace_packet.h"
#include "shared/camera.h"
#include "shared/material.h"
#include "shared/surface.h"

// What varies materials within a triangle; then every point has one of its own.
#define VARIES_MATERIALS (HAS_TEXTURES || HAS_COLORS)

#if HAS_SMOOTH
#define NORMAL_PARAMETERS , __global const float* vertex_normals
#define NORMAL_ARGUMENTS , vertex_normals
#else
#define NORMAL_PARAMETERS
#define NORMAL_ARGUMENTS
#endif
#if VARIES_MATERIALS
#define MATERIAL_PARAMETERS , __global Material *materials, uint own_materials
#define MATERIAL_ARGUMENTS , materials, own_materials
#else
#define MATERIAL_PARAMETERS
#define MATERIAL_ARGUMENTS
#endif
#if HAS_TEXTURES && HAS_TANGENTS
#define MAP_PARAMETERS , TEXTURE_PARAMETERS, __global const float4* tangents
#define MAP_ARGUMENTS , TEXTURE_ARGUMENTS, tangents
#elif HAS_TEXTURES
#define MAP_PARAMETERS , TEXTURE_PARAMETERS
#define MAP_ARGUMENTS , TEXTURE_ARGUMENTS
#else
#define MAP_PARAMETERS
#define MAP_ARGUMENTS
#endif
#if HAS_COLORS
#define COLOR_PARAMETERS , __global const float4* colors
#define COLOR_ARGUMENTS , colors
#else
#define COLOR_PARAMETERS
#define COLOR_ARGUMENTS
#endif
#if HAS_INSTANCES
#define PLACE_PARAMETERS , __global const Instance *instances, uint instance_count
#define PLACE_ARGUMENTS , instances, instance_count
#else
#define PLACE_PARAMETERS
#define PLACE_ARGUMENTS
#endif
#define MESH_PARAMETERS                                                               \
    __global const float *vertices, __global const uint *indices,                     \
        __global const uint *triangle_materials NORMAL_PARAMETERS MATERIAL_PARAMETERS \
            MAP_PARAMETERS COLOR_PARAMETERS PLACE_PARAMETERS
#define MESH_ARGUMENTS                                                                       \
    vertices, indices,                                                                       \
        triangle_materials NORMAL_ARGUMENTS MATERIAL_ARGUMENTS MAP_ARGUMENTS COLOR_ARGUMENTS \
            PLACE_ARGUMENTS

// The primary ray of an item, from where it meets the near plane, at `start`, to the far one;
// `jitter` 0 puts it through the pixel's centre.
static Ray primary_ray(Tiles tiles, uint item, Camera camera, uint jitter, uint pixel_sample,
                       uint seed, float* start) {
    const uint2 pixel = item_pixel(tiles, item);
    const float2 within = jitter
                              ? pixel_position(pixel.y * tiles.width + pixel.x, pixel_sample, seed)
                              : (float2)(0.5f);
    const float sx = 2.0f * ((float)pixel.x + within.x) / (float)tiles.width - 1.0f;
    const float sy = 1.0f - 2.0f * ((float)pixel.y + within.y) / (float)tiles.height;
    const float3 offset = camera.right.xyz * sx + camera.up.xyz * sy;
    const bool orthographic = camera.forward.w != 0.0f;
    const float3 towards = camera.forward.xyz + offset;
    const float along = orthographic ? 1.0f : length(towards);  // per unit of distance to a plane
    *start = camera.right.w * along;
    const Ray ray = {orthographic ? camera.origin.xyz + offset : camera.origin.xyz,
                     orthographic ? camera.forward.xyz : normalize(towards),
                     camera.up.w > 0.0f ? camera.up.w * along : INFINITY};
    return ray;
}

// The direction in which a texture's u grows along a triangle; w: 1, or -1 where the image is
// mirrored, as glTF's tangents have it.
static float4 tangent_of(MapCorners at, float3 edge1, float3 edge2) {
    const float area = at.edge1.x * at.edge2.y - at.edge1.y * at.edge2.x;
    const float3 along = edge1 * at.edge2.y - edge2 * at.edge1.y;
    return (float4)(area < 0.0f ? -along : along, area < 0.0f ? 1.0f : -1.0f);
}

// The shading normal that a normal map's texel means, beside `normal`, which is on the viewer's
// side; as it is where there is no tangent.
static float3 map_normal(float3 texel, float scale, float3 normal, float4 tangent, bool front) {
    const float3 along = tangent.xyz - normal * dot(normal, tangent.xyz);
    const float squared = dot(along, along);
    if (!(squared > 0.0f)) return normal;
    const float3 x = along / sqrt(squared);
    const float3 y = cross(normal, x);
    const float3 in = (2.0f * texel - 1.0f) * (float3)(scale, scale, 1.0f);
    const float3 mapped =
        x * (front ? in.x : -in.x) + y * (tangent.w < 0.0f ? -in.y : in.y) + normal * in.z;
    return dot(mapped, mapped) > 0.0f ? normalize(mapped) : normal;
}

#if HAS_SMOOTH
// How high a vertex's tangent plane, which has normal n, is along `normal` over a point of the
// triangle at `from` the vertex; 0 below it.
static float height_of_plane(float3 n, float3 from, float3 normal) {
    return -min(dot(n, from), 0.0f) * dot(n, normal);
}
#endif

// What rounding took from a sum, a difference and a product: with it they are exact (Knuth, "The
// Art of Computer Programming" 2, 4.2.2; Dekker, "A Floating-Point Technique for Extending the
// Available Precision", 1971).
static float3 lost_by_sum(float3 a, float3 b, float3 sum) {
    const float3 from_b = sum - a;
    return (a - (sum - from_b)) + (b - from_b);
}

static float3 upper_half(float3 a) {
    const float3 c = 4097.0f * a;
    return c - (c - a);
}

static float3 lost_by_product(float3 a, float3 b, float3 product) {
    const float3 a1 = upper_half(a), b1 = upper_half(b);
    const float3 a2 = a - a1, b2 = b - b1;
    return ((a1 * b1 - product) + a1 * b2 + a2 * b1) + a2 * b2;
}

// The point of a triangle with those weights of vertices 1 and 2, rounded once: in its plane
// however large the triangle is.
static float3 point_of(float3 v0, float3 v1, float3 v2, float2 weights) {
    const float3 u = (float3)(weights.x), v = (float3)(weights.y);
    const float3 edge1 = v1 - v0, edge2 = v2 - v0;
    const float3 along1 = edge1 * u, along2 = edge2 * v;
    const float3 sum1 = v0 + along1;
    const float3 sum2 = sum1 + along2;
    const float3 lost1 = lost_by_product(edge1, u, along1) + lost_by_sum(v1, -v0, edge1) * u;
    const float3 lost2 = lost_by_product(edge2, v, along2) + lost_by_sum(v2, -v0, edge2) * v;
    const float3 lost = lost_by_sum(v0, along1, sum1) + lost_by_sum(sum1, along2, sum2);
    return sum2 + (lost1 + lost2 + lost);
}

// The surface where a ray hits a triangle; ~0: none.
static void write_surface(Tiles tiles, Camera camera, __global Surface* surfaces, uint item,
                          Ray ray, uint triangle, float distance, MESH_PARAMETERS) {
    __global Surface* surface = surfaces + item;
    if (triangle == ~0u) {
        surface->position = (float4)(0.0f, 0.0f, 0.0f, -1.0f);
        return;
    }
    surface->triangle = triangle;
#if HAS_INSTANCES
    __global const Instance* in = find_instance(instances, instance_count, triangle);
    if (in) triangle = in->stored + (triangle - in->first);
    uint3 corner = vload3(triangle, indices);
    if (in && in->mirrored) corner = corner.xzy;
#else
    const uint3 corner = vload3(triangle, indices);
#endif
    const float3 v0 = point_to_world(in, vload3(corner.x, vertices));
    const float3 v1 = point_to_world(in, vload3(corner.y, vertices));
    const float3 v2 = point_to_world(in, vload3(corner.z, vertices));
    const float3 edge1 = v1 - v0, edge2 = v2 - v0;
    const float3 face = cross(edge1, edge2);
    const float2 weights = hit_weights(ray, v0, edge1, edge2);
    const bool front = dot(face, ray.direction) < 0.0f;
    // The square of a small face would be too small for a float.
    const float largest = max(largest_part(face), 1e-37f);
    const float3 scaled = face / largest;
    const float3 geometric = normalize(front ? scaled : -scaled);
    float3 normal = geometric;
#if HAS_SMOOTH
    const float3 n0 = normal_to_world(in, vload3(corner.x, vertex_normals));
    const float3 n1 = normal_to_world(in, vload3(corner.y, vertex_normals));
    const float3 n2 = normal_to_world(in, vload3(corner.z, vertex_normals));
    const float weight0 = 1.0f - weights.x - weights.y;
    const float3 smooth = n0 * weight0 + n1 * weights.x + n2 * weights.y;
    const float side = dot(smooth, geometric) < 0.0f ? -1.0f : 1.0f;
    if (dot(smooth, smooth) > 0.0f) normal = normalize(side * smooth);
#endif
    const float3 sizes = fabs(v0) + fabs(edge1 * weights.x) + fabs(edge2 * weights.y);
    float3 position = point_of(v0, v1, v2, weights);
    // In a triangle that is larger than the view, weights are too coarse to tell where in its plane
    // the point is; the ray tells.
    const float3 seen = ray.origin + ray.direction * distance;
    if (largest_part(fabs(ray.origin) + fabs(ray.direction) * distance) < largest_part(sizes))
        position = seen + geometric * dot(geometric, position - seen);
    float3 parts = fabs(position) + 1e-6f * sizes;
#if HAS_INSTANCES
    if (in) {
        const float3 place = place_of(in);
        const float3 corners = max(max(fabs(v0 - place), fabs(v1 - place)), fabs(v2 - place));
        parts += multiply_sizes(in->to_world, multiply_sizes(in->to_object, corners));
    }
#endif
    surface->position = (float4)(position, distance);
    surface->normal = (float4)(normal, 0.0f);
    surface->horizon = (float4)(geometric, OFFSET_SCALE * dot(fabs(geometric), parts));
#if HAS_SMOOTH
    const float3 from = edge1 * weights.x + edge2 * weights.y;
    const float lift = weight0 * height_of_plane(side * n0, from, normal) +
                       weights.x * height_of_plane(side * n1, from - edge1, normal) +
                       weights.y * height_of_plane(side * n2, from - edge2, normal);
    if (lift > LEAST_LIFT * (length(edge1) + length(edge2)))
        surface->horizon =
            (float4)(normal, lift + surface->horizon.w / max(dot(normal, geometric), LEAST_SLOPE));
#endif
    const uint material = triangle_materials[triangle];
    surface->material = material;
    surface->front = front ? 1u : 0u;
#if VARIES_MATERIALS
    Material own = materials[material];
    float3 color = (float3)(1.0f);
#if HAS_COLORS
    color = colors[corner.x].xyz * (1.0f - weights.x - weights.y) +
            colors[corner.y].xyz * weights.x + colors[corner.z].xyz * weights.y;
#endif
#if HAS_TEXTURES
    const float share = seen_area(tiles, camera, ray.direction, distance, geometric) /
                        max(largest * length(scaled), 1e-37f);
    const uint map = MAP_KIND_COUNT * material;
    color *= sample_map(TEXTURE_ARGUMENTS, map + MAP_BASE_COLOR, corner, weights, share).xyz;
    const float4 polish =
        sample_map(TEXTURE_ARGUMENTS, map + MAP_METALLIC_ROUGHNESS, corner, weights, share);
    own.base_color.w *= polish.z;
    own.roughness = max(own.roughness * polish.y * polish.y, SMALLEST_ALPHA);
    own.emission.xyz *=
        sample_map(TEXTURE_ARGUMENTS, map + MAP_EMISSION, corner, weights, share).xyz;
#if HAS_SPECULAR_MAPS
    own.specular *= sample_map(TEXTURE_ARGUMENTS, map + MAP_SPECULAR, corner, weights, share).w;
    own.reflectance.xyz =
        min(own.reflectance.xyz *
                sample_map(TEXTURE_ARGUMENTS, map + MAP_SPECULAR_COLOR, corner, weights, share).xyz,
            1.0f);
#endif
    if (maps[map + MAP_NORMAL].texture != NO_TEXTURE) {
        const float3 texel =
            sample_map(TEXTURE_ARGUMENTS, map + MAP_NORMAL, corner, weights, share).xyz;
        float4 tangent = (float4)(0.0f);
#if HAS_TANGENTS
        tangent = tangent_to_world(in, tangents[corner.x]) * (1.0f - weights.x - weights.y) +
                  tangent_to_world(in, tangents[corner.y]) * weights.x +
                  tangent_to_world(in, tangents[corner.z]) * weights.y;
#endif
        if (dot(tangent.xyz, tangent.xyz) == 0.0f)
            tangent =
                tangent_of(map_corners(maps + map + MAP_NORMAL, coordinates, vertex_count, corner),
                           edge1, edge2);
        normal = map_normal(texel, maps[map + MAP_NORMAL].scale, normal, tangent, front);
        surface->normal = (float4)(normal, 0.0f);
    }
#endif
    if (own.unlit != 0u)
        own.emission.xyz *= color;
    else
        own.base_color.xyz *= color;
    materials[own_materials + item] = own;
    surface->shading = own_materials + item;
#else
    surface->shading = material;
#endif
}

// surfaces[item], one item per work-item.
KERNEL void gbuffer_trace_rays(Tiles tiles, Camera camera, uint jitter, uint pixel_sample,
                               uint seed, BVH_PARAMETERS, MESH_PARAMETERS,
                               __global Surface* surfaces) {
    const uint item = get_global_id(0);
    if (!item_in_image(tiles, item)) return;
    float start;
    const Ray ray = primary_ray(tiles, item, camera, jitter, pixel_sample, seed, &start);
    const Hit hit = closest_hit(BVH_ARGUMENTS, ray, start);
    write_surface(tiles, camera, surfaces, item, ray, hit.triangle, hit.t, MESH_ARGUMENTS);
}

#if LANES > 1
// The same, 16 items (4 x 4 pixels) per work-item; for cameras whose rays have one origin.
KERNEL void gbuffer_trace_packets(Tiles tiles, Camera camera, uint jitter, uint pixel_sample,
                                  uint seed, BVH_PARAMETERS, MESH_PARAMETERS,
                                  __global Surface* surfaces) {
    const uint first = 16u * (uint)get_global_id(0);
    Packet packet;
    float_n starts[PARTS];
    packet.origin = camera.origin.xyz;
    for (uint i = 0u; i < PARTS; ++i)
        packet.x[i] = packet.y[i] = packet.z[i] = packet.end[i] = starts[i] = (float_n)(0.0f);
    for (uint i = 0u; i < 16u; ++i) {
        if (!item_in_image(tiles, first + i)) continue;
        float start;
        const Ray ray = primary_ray(tiles, first + i, camera, jitter, pixel_sample, seed, &start);
        SET_LANE(packet.x, i, ray.direction.x);
        SET_LANE(packet.y, i, ray.direction.y);
        SET_LANE(packet.z, i, ray.direction.z);
        SET_LANE(packet.end, i, ray.end);
        SET_LANE(starts, i, start);
    }
    if (!rays_of(&packet)) return;
    prepare_packet(&packet);
    int_n triangles[PARTS];
    closest_hits(BVH_ARGUMENTS, &packet, starts, triangles);
    for (uint i = 0u; i < 16u; ++i) {
        if (!item_in_image(tiles, first + i)) continue;
        const Ray ray = {packet.origin, direction_of(&packet, i), INFINITY};
        write_surface(tiles, camera, surfaces, first + i, ray, (uint)INT_LANE(triangles, i),
                      LANE(packet.end, i), MESH_ARGUMENTS);
    }
}
#endif

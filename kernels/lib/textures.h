// SPDX-License-Identifier: MIT
// Textures as glTF 2.0 samples them (shared/texture.h), from one buffer of texels.
#ifndef MANYLIGHT_LIB_TEXTURES_H
#define MANYLIGHT_LIB_TEXTURES_H

#include "lib/common.h"
#include "shared/texture.h"

// IEC 61966-2-1.
static float decode_srgb(float v) {
    return v <= 0.04045f ? v * (1.0f / 12.92f) : pow((v + 0.055f) * (1.0f / 1.055f), 2.4f);
}

// Texel `index` of those that start at a word, linear.
static float4 load_texel(__global const uint* words, uint index, uint format) {
    if (format == TEXELS_HALF) return vload_half4(index, (__global const half*)words);
    float4 texel = convert_float4(vload4(index, (__global const uchar*)words)) * (1.0f / 255.0f);
    if (format == TEXELS_SRGB) {
        texel.x = decode_srgb(texel.x);
        texel.y = decode_srgb(texel.y);
        texel.z = decode_srgb(texel.z);
    }
    return texel;
}

// Large coordinates to small ones that mean the same, so that they resolve texels.
static float wrap_coordinate(float x, uint wrap) {
    return wrap == WRAP_CLAMP ? clamp(x, -1.0f, 2.0f) : x - 2.0f * floor(0.5f * x);
}

// The texel of a side that stands for texel i; of it for every i.
static uint wrap_texel(int i, int side, uint wrap) {
    if (wrap == WRAP_CLAMP) return (uint)clamp(i, 0, side - 1);
    const int period = wrap == WRAP_MIRROR ? 2 * side : side;
    i %= period;
    if (i < 0) i += period;
    return (uint)(i < side ? i : period - 1 - i);
}

// One level at (u, v), whose texels' centres are at (i + 1/2) / side.
static float4 sample_level(__global const uint* texels, __global const Texture* texture, uint level,
                           float2 uv, uint linear) {
    const uint format = texture->format;
    uint first = texture->first;
    for (uint i = 0u; i < level; ++i)
        first += max(texture->width >> i, 1u) * max(texture->height >> i, 1u) *
                 (format == TEXELS_HALF ? 2u : 1u);
    __global const uint* words = texels + first;
    const int width = (int)max(texture->width >> level, 1u);
    const int height = (int)max(texture->height >> level, 1u);
    const float shift = linear ? 0.5f : 0.0f;
    const float x = wrap_coordinate(uv.x, texture->wrap_u) * (float)width - shift;
    const float y = wrap_coordinate(uv.y, texture->wrap_v) * (float)height - shift;
    const int left = (int)floor(x);
    const int top = (int)floor(y);
    const uint x0 = wrap_texel(left, width, texture->wrap_u);
    const uint row0 = wrap_texel(top, height, texture->wrap_v) * (uint)width;
    if (!linear) return load_texel(words, row0 + x0, format);
    const uint x1 = wrap_texel(left + 1, width, texture->wrap_u);
    const uint row1 = wrap_texel(top + 1, height, texture->wrap_v) * (uint)width;
    const float fx = x - floor(x);
    const float fy = y - floor(y);
    return mix(mix(load_texel(words, row0 + x0, format), load_texel(words, row0 + x1, format), fx),
               mix(load_texel(words, row1 + x0, format), load_texel(words, row1 + x1, format), fx),
               fy);
}

// A texture at (u, v), where a pixel sees `area` of its unit square: at the level whose texels have
// that area, or between two.
static float4 sample_texture(__global const uint* texels, __global const Texture* texture,
                             float2 uv, float area) {
    const float level = 0.5f * log2(area * (float)texture->width * (float)texture->height);
    if (!(level > 0.0f)) return sample_level(texels, texture, 0u, uv, texture->magnified_linear);
    const uint linear = texture->minified_linear;
    if (texture->between == LEVELS_FINEST) return sample_level(texels, texture, 0u, uv, linear);
    const float last = (float)(texture->levels - 1u);
    const float at = min(level, last);
    if (texture->between == LEVELS_NEAREST)
        return sample_level(texels, texture, (uint)floor(at + 0.5f), uv, linear);
    const uint finer = (uint)floor(at);
    const float4 found = sample_level(texels, texture, finer, uv, linear);
    if (at >= last) return found;
    return mix(found, sample_level(texels, texture, finer + 1u, uv, linear), at - floor(at));
}

#define TEXTURE_PARAMETERS                                             \
    __global const TextureMap *maps, __global const Texture *textures, \
        __global const uint *texels, __global const float2 *coordinates, uint vertex_count
#define TEXTURE_ARGUMENTS maps, textures, texels, coordinates, vertex_count

// Texture coordinates of a triangle's corners, transformed.
typedef struct MapCorners {
    float2 at;     // corner 0
    float2 edge1;  // to corner 1
    float2 edge2;  // to corner 2
} MapCorners;

static MapCorners map_corners(__global const TextureMap* map, __global const float2* coordinates,
                              uint vertex_count, uint3 corner) {
    __global const float2* set = coordinates + (ulong)map->set * vertex_count;
    const float2 a = set[corner.x];
    const float2 b = set[corner.y] - a;
    const float2 c = set[corner.z] - a;
    const float4 u = map->u, v = map->v;
    MapCorners m;
    m.at = (float2)(u.x * a.x + u.y * a.y + u.z, v.x * a.x + v.y * a.y + v.z);
    m.edge1 = (float2)(u.x * b.x + u.y * b.y, v.x * b.x + v.y * b.y);
    m.edge2 = (float2)(u.x * c.x + u.y * c.y, v.x * c.x + v.y * c.y);
    return m;
}

// What a map holds for the point with these weights of vertices 1 and 2, where a pixel sees `share`
// of the parallelogram of the triangle's edges; 1 where there is no texture.
static float4 sample_map(TEXTURE_PARAMETERS, uint map, uint3 corner, float2 weights, float share) {
    const uint texture = maps[map].texture;
    if (texture == NO_TEXTURE) return (float4)(1.0f);
    const MapCorners m = map_corners(maps + map, coordinates, vertex_count, corner);
    const float area = fabs(m.edge1.x * m.edge2.y - m.edge1.y * m.edge2.x) * share;
    return sample_texture(texels, textures + texture,
                          m.at + m.edge1 * weights.x + m.edge2 * weights.y, area);
}

#endif

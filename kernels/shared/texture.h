// SPDX-License-Identifier: MIT
#ifndef MANYLIGHT_SHARED_TEXTURE_H
#define MANYLIGHT_SHARED_TEXTURE_H

#include "shared/types.h"

SHARED_BEGIN

/// What a texel is stored as: 4 bytes, of which the first three are encoded as sRGB (IEC 61966-2-1)
/// or all are linear, 0 to 255 for 0 to 1; or 4 halves.
enum TexelFormat { TEXELS_SRGB = 0, TEXELS_LINEAR = 1, TEXELS_HALF = 2 };

/// Where coordinates beyond 0 and 1 lead.
enum TextureWrap { WRAP_REPEAT = 0, WRAP_CLAMP = 1, WRAP_MIRROR = 2 };

/// Between the levels of a texture that is seen smaller than its finest one is.
enum TextureLevels { LEVELS_FINEST = 0, LEVELS_NEAREST = 1, LEVELS_BLENDED = 2 };

/// An image with its sampler, as glTF 2.0 has them. Its levels follow one another in the buffer of
/// texels, rows from the top, each with half the texels of the one before along a side, rounded
/// down, but at least one.
typedef struct Texture {
    uint first;             // word of the buffer at which the finest level starts
    uint width;             // texels of the finest level
    uint height;            // texels of the finest level
    uint levels;            // number of levels
    uint format;            // TexelFormat
    uint wrap_u;            // TextureWrap
    uint wrap_v;            // TextureWrap
    uint magnified_linear;  // 1: texels are interpolated where the finest level is seen enlarged
    uint minified_linear;   // 1: ... where it is seen smaller
    uint between;           // TextureLevels
    uint padding0;
    uint padding1;
} Texture;
SHARED_SIZE(Texture, 48)

#define NO_TEXTURE 0xffffffffu

/// What a material takes from textures; the order of its maps.
enum MapKind {
    MAP_BASE_COLOR = 0,
    MAP_METALLIC_ROUGHNESS = 1,  // metallic in B, the root of Material::roughness in G
    MAP_NORMAL = 2,              // in the frame of the tangents
    MAP_EMISSION = 3,
    MAP_SPECULAR = 4,        // Material::specular in A
    MAP_SPECULAR_COLOR = 5,  // of Material::reflectance
    MAP_KIND_COUNT = 6
};

/// How a material sees a texture: at (dot(u, (s, t, 1)), dot(v, (s, t, 1))), where s and t are
/// interpolated between the vertices (KHR_texture_transform).
typedef struct TextureMap {
    float4 u;      // xyz
    float4 v;      // xyz
    uint texture;  // index in Scene::textures, or NO_TEXTURE
    uint set;      // of texture coordinates, in Scene::coordinates
    float scale;   // of a normal's x and y
    uint padding;
} TextureMap;
SHARED_SIZE(TextureMap, 48)

/// A triangle of which not all is there, or not for all rays.
typedef struct AlphaTriangle {
    float4 first;   // xy: where corner 0 is on the texture; zw: from there to corner 1
    float4 second;  // xy: from corner 0 to corner 2; z: the material's cutoff
    float4 alphas;  // xyz: of the corners, times the texture's
    uint texture;   // index in Scene::textures, or NO_TEXTURE
    uint culled;    // the material's
    uint padding0;
    uint padding1;
} AlphaTriangle;
SHARED_SIZE(AlphaTriangle, 64)

/// A triangle that is there as a whole.
#define NO_ALPHA 0xffffffffu

SHARED_END

#endif

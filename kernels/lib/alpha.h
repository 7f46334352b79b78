// SPDX-License-Identifier: MIT
// What rays pass through: triangles of which not all is there (shared/texture.h). Where there are
// none, nothing is left of this.
#ifndef MANYLIGHT_LIB_ALPHA_H
#define MANYLIGHT_LIB_ALPHA_H

#include "lib/random.h"
#include "lib/textures.h"

#if HAS_ALPHA
#define ALPHA_PARAMETERS                                                            \
    , __global const uint *alpha_of, __global const AlphaTriangle *alpha_triangles, \
        __global const Texture *alpha_textures, __global const uint *alpha_texels, uint alpha_salt
#define ALPHA_ARGUMENTS , alpha_of, alpha_triangles, alpha_textures, alpha_texels, alpha_salt

// A fraction of 1 as if drawn at random for a ray and a triangle. Rays that are the same in several
// pixel samples differ by the salt.
static float ray_fraction(float3 origin, float3 direction, uint triangle, uint salt) {
    const uint4 from = random_bits(as_uint(origin.x), as_uint(origin.y), as_uint(origin.z), salt);
    return unit_float(random_bits(as_uint(direction.x) ^ from.x, as_uint(direction.y) ^ from.y,
                                  as_uint(direction.z) ^ from.z, triangle ^ from.w)
                          .x);
}

// Whether the triangle is there, where the ray meets it, with those weights of its vertices 1 and
// 2; `behind`: it meets its back; `seen`: the triangle's index as seen, which is another one in
// each instance. The texture's finest level says so for rays of every kind: what is there does not
// depend on who looks. Of a surface that is partly there everywhere, it is for that part of all
// rays.
static bool is_there(float3 origin, float3 direction, uint triangle, uint seen, float2 weights,
                     bool behind ALPHA_PARAMETERS) {
    const uint index = alpha_of[triangle];
    if (index == NO_ALPHA) return true;
    __global const AlphaTriangle* t = alpha_triangles + index;
    if (behind && t->culled) return false;
    const float cutoff = t->second.z;
    if (cutoff == 0.0f) return true;
    const float4 alphas = t->alphas;
    float alpha =
        alphas.x * (1.0f - weights.x - weights.y) + alphas.y * weights.x + alphas.z * weights.y;
    if (t->texture != NO_TEXTURE) {
        __global const Texture* texture = alpha_textures + t->texture;
        const float2 uv = t->first.xy + t->first.zw * weights.x + t->second.xy * weights.y;
        alpha *= sample_level(alpha_texels, texture, 0u, uv, texture->magnified_linear).w;
    }
    if (cutoff > 0.0f) return alpha >= cutoff;
    return ray_fraction(origin, direction, seen, alpha_salt) < alpha;
}
#else
#define ALPHA_PARAMETERS
#define ALPHA_ARGUMENTS
#endif

#endif

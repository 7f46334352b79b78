// SPDX-License-Identifier: MIT
#ifndef MANYLIGHT_SHARED_LIGHT_H
#define MANYLIGHT_SHARED_LIGHT_H

#include "shared/types.h"

SHARED_BEGIN

/// What kinds of light have in common, X(NAME, value): host and kernels ask for these, not for
/// kinds, where several may be meant. Kernels are compiled with HAS_<NAME> for those of the scene
/// at hand.
///
/// EVEN      shines alike in all directions in which it shines
/// CONE      shines about its axis, less at larger angles (edge.x, edge.y)
/// COSINE    shines by the cosine to its axis, or to its normal if it has an area
/// AREA      a shape of axis and edge: what it gives depends on the point of it that is seen
/// RANGE     axis.w is its range
/// INFINITE  infinitely far
#define LIGHT_TRAITS(X) \
    X(EVEN, 1)          \
    X(CONE, 2)          \
    X(COSINE, 4)        \
    X(AREA, 8)          \
    X(RANGE, 16)        \
    X(INFINITE, 32)

#define LIGHT_TRAIT_VALUE(NAME, value) TRAIT_##NAME = value,
enum LightTrait { LIGHT_TRAITS(LIGHT_TRAIT_VALUE) no_light_trait = 0 };
#undef LIGHT_TRAIT_VALUE

/// The kinds of light, X(name, NAME, value, traits, centroid): one of the traits EVEN, CONE and
/// COSINE, and what else it has; an area's centroid is its point u = v = 1 / centroid. A kind is a
/// row here, kernels/lights/<name>.h, a function in host/lights/kinds.cpp and
/// host/reference/lights/<name>.cpp.
#define LIGHT_KINDS(X)                                             \
    X(point, POINT, 0, TRAIT_EVEN | TRAIT_RANGE, 2)                \
    X(spot, SPOT, 1, TRAIT_CONE | TRAIT_RANGE, 2)                  \
    X(directional, DIRECTIONAL, 2, TRAIT_EVEN | TRAIT_INFINITE, 2) \
    X(oriented, ORIENTED, 3, TRAIT_COSINE, 2)                      \
    X(triangle, TRIANGLE, 4, TRAIT_COSINE | TRAIT_AREA, 3)         \
    X(quad, QUAD, 5, TRAIT_COSINE | TRAIT_AREA, 2)

#define LIGHT_KIND_VALUE(name, NAME, value, traits, centroid) LIGHT_##NAME = value,
enum LightKind { LIGHT_KINDS(LIGHT_KIND_VALUE) light_kind_count = 6 };
#undef LIGHT_KIND_VALUE

/// Whether a kind has a LightTrait; no other number does.
static inline bool light_has(uint kind, uint trait) {
#define LIGHT_KIND_HAS(name, NAME, value, traits, centroid) \
    || (kind == value && ((traits)&trait) != 0)
    return false LIGHT_KINDS(LIGHT_KIND_HAS);
#undef LIGHT_KIND_HAS
}

/// n, where the centroid of an area of this kind is its point u = v = 1 / n.
static inline uint light_centroid_parts(uint kind) {
#define LIGHT_KIND_PARTS(name, NAME, value, traits, centroid) kind == value ? centroid:
    return LIGHT_KINDS(LIGHT_KIND_PARTS) 2;
#undef LIGHT_KIND_PARTS
}

// clang-format off
/// One light, world space, metres, glTF's photometric units.
///
///             position.xyz  axis.xyz                edge.xyz         emission.rgb
/// point       position      -                       -                intensity, cd
/// spot        position      unit, where it shines   x, y: as below   intensity on the axis, cd
/// directional -             unit, where it shines   x, y: as below   illuminance, lx
/// oriented    position      unit normal             -                intensity on the normal, cd
/// triangle    vertex 0      vertex 1 - vertex 0     vertex 2 - 0     radiance, cd/m2
/// quad        a corner      a side from there       the other side   radiance, cd/m2
///
/// A spot's intensity at an angle off its axis is that on the axis x clamp((y - v) x, 0, 1)^2,
/// where v = 1 - cos(angle): KHR_lights_punctual, but for cosines, which do not tell small angles
/// apart. A directional light comes from infinitely far if its y is 0, or else from the plane
/// dot(axis, p) = x: nothing before that casts a shadow. An oriented point is Lambert's (cosine). A
/// quad is a parallelogram; it and a triangle face cross(axis, edge).
// clang-format on
typedef struct Light {
    float4 position;  // w: the LightKind
    float4 axis;      // w: point, spot: range, m, 0 if none; triangle, quad: 1 if both sides emit
    float4 edge;      // w: oriented, triangle, quad: how far before the light shadow rays end
    float4 emission;  // w: luminous power, lm (directional: through the scene's bounding disc)
} Light;
SHARED_SIZE(Light, 64)

SHARED_END

#endif

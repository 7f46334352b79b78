// SPDX-License-Identifier: MIT
#ifndef MANYLIGHT_SHARED_LIGHT_H
#define MANYLIGHT_SHARED_LIGHT_H

#include "shared/types.h"

SHARED_BEGIN

/// The kinds of light, X(name, NAME, value). A kind is a row here, `light_<name>` in
/// kernels/lib/lights.h and a case in host/reference/shading.cpp.
#define LIGHT_KINDS(X)             \
    X(point, POINT, 0)             \
    X(spot, SPOT, 1)               \
    X(directional, DIRECTIONAL, 2) \
    X(oriented, ORIENTED, 3)       \
    X(triangle, TRIANGLE, 4)       \
    X(quad, QUAD, 5)

#define LIGHT_KIND_VALUE(name, NAME, value) LIGHT_##NAME = value,
enum LightKind { LIGHT_KINDS(LIGHT_KIND_VALUE) light_kind_count = 6 };
#undef LIGHT_KIND_VALUE

// clang-format off
/// One light, world space, metres, glTF's photometric units.
///
///             position.xyz  axis.xyz                edge.xyz         emission.rgb
/// point       position      -                       -                intensity, cd
/// spot        position      unit, where it shines   x, y: as below   intensity on the axis, cd
/// directional -             unit, where it shines   -                illuminance, lx
/// oriented    position      unit normal             -                intensity on the normal, cd
/// triangle    vertex 0      vertex 1 - vertex 0     vertex 2 - 0     radiance, cd/m2
/// quad        a corner      a side from there       the other side   radiance, cd/m2
///
/// A spot's intensity at an angle off its axis is that on the axis x clamp((y - v) x, 0, 1)^2,
/// where v = 1 - cos(angle): KHR_lights_punctual, but for cosines, which do not tell small angles
/// apart. An oriented point is Lambert's (cosine). A quad is a parallelogram; it and a triangle
/// face cross(axis, edge).
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

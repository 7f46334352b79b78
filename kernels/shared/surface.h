// SPDX-License-Identifier: MIT
#ifndef MANYLIGHT_SHARED_SURFACE_H
#define MANYLIGHT_SHARED_SURFACE_H

#include "shared/types.h"

SHARED_BEGIN

/// What a primary ray hit: one entry of the G-buffer, world space, metres.
typedef struct Surface {
    float4 position;   // xyz; w: distance from the ray's origin, negative where the ray missed
    float4 normal;     // xyz: unit shading normal on the viewer's side
    float4 geometric;  // xyz: unit normal of the triangle on the viewer's side;
                       // w: distance by which shadow rays start off the surface (see OFFSET_SCALE)
    uint triangle;     // index in Scene::indices / 3, or an instance's
    uint material;     // index in Scene::materials
    uint front;        // 1 where the viewer is on the side that the triangle's winding faces
    uint shading;      // index of what it shades with, on the device: `material`, or behind the
                       // scene's materials one of its own where textures or colours vary it
} Surface;
SHARED_SIZE(Surface, 64)

/// Shadow rays start and end off a surface by this times the largest coordinate of its triangle's
/// vertices, and of these relative to the place of the instance that it is of: the position's
/// rounding error is a few units in the last place of those (the bound of Pharr, Jakob, Humphreys,
/// "Physically Based Rendering" 3rd ed., 3.9.4, with room to spare).
#define OFFSET_SCALE 4e-6f

SHARED_END

#endif

// SPDX-License-Identifier: MIT
#ifndef MANYLIGHT_SHARED_SURFACE_H
#define MANYLIGHT_SHARED_SURFACE_H

#include "shared/types.h"

SHARED_BEGIN

/// What a primary ray hit: one entry of the G-buffer, world space, metres.
typedef struct Surface {
    float4 position;  // xyz; w: distance from the ray's origin, negative where the ray missed
    float4 normal;    // xyz: unit shading normal on the viewer's side
    float4 horizon;   // xyz: unit normal on the viewer's side of the plane below which no light
                      // shines: the triangle's, or the vertices' where that is lifted;
                      // w: distance along it at which shadow rays start (see LEAST_LIFT)
    uint triangle;    // index in Scene::indices / 3, or an instance's
    uint material;    // index in Scene::materials
    uint front;       // 1 where the viewer is on the side that the triangle's winding faces
    uint shading;     // index of what it shades with, on the device: `material`, or behind the
                      // scene's materials one of its own where textures or colours vary it
} Surface;
SHARED_SIZE(Surface, 64)

/// Of a receiver that no camera sees (a vertex of a path, a gather point): where its light goes,
/// and what of it counts. Its Surface's normals are on the side of `direction`.
typedef struct Outgoing {
    float4 direction;   // xyz: unit
    float4 throughput;  // rgb: what its radiance is multiplied by
} Outgoing;
SHARED_SIZE(Outgoing, 32)

/// Shadow rays start off a surface with unit normal n by this times the sum over axes of |n_i| p_i,
/// where p bounds what single precision rounds of the point, along each axis: its coordinate, of an
/// instance (|to_world| |to_object| |c|)_i besides, where c is the farthest corner from its place,
/// and 1e-6 of the sizes of what the point is made of, a vertex and parts of two edges. They end
/// off an emitter likewise, with p the largest coordinates of its vertices.
///
/// Derivation, with e = 2^-23 (each rounding is of e/2): the point is a sum without rounding that
/// is rounded once, or twice on large triangles, and putting it off the plane rounds it again: 2 e
/// of its coordinates, and e times that of what it is made of. To an instance's frame and back,
/// differences, matrices and sums of three products come to 7 e of their part. A point of an
/// emitter is a sum of an area's corner and sides, each rounded before: 8 e. This is 10 e. What the
/// test of a triangle rounds is not in it (see prepare_block() in kernels/lib/block.h). (After
/// Pharr, Jakob, Humphreys, "Physically Based Rendering" 4th ed., 6.8.)
#define OFFSET_SCALE 1.2e-6f

/// A mesh with vertex normals stands for a rounder body, of which its triangles cut off the bulge.
/// Where these turn from the light, its shadow would end the light in steps. So shadow rays start
/// where the body would be: at the height of the vertices' tangent planes over the triangle, as
/// they are interpolated, along the interpolated normal, and light is below the horizon where it is
/// below that normal's plane. Lifts of less than this times the length of two edges are none: the
/// triangle is flat, or hollow.
/// The rounding of the hit is cleared along that normal, too, but as if it stood off the triangle's
/// by no more than a cosine of LEAST_SLOPE.
/// (Hanika, "Hacking the Shadow Terminator", Ray Tracing Gems II, 2021, ch. 4.)
#define LEAST_LIFT 1e-4f
#define LEAST_SLOPE 0.0625f

SHARED_END

#endif

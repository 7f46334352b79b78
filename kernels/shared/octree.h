// SPDX-License-Identifier: MIT
#ifndef MANYLIGHT_SHARED_OCTREE_H
#define MANYLIGHT_SHARED_OCTREE_H

#include "shared/types.h"

SHARED_BEGIN

/// A node of the octree of lights (Paquette, Poulin, Drettakis, "A Light Hierarchy for Fast
/// Rendering of Scenes with Many Lights", 1998), world space, metres. Nodes are in depth-first
/// order: the children of node i are i + 1, the `next` of that, and so on as long as they are below
/// the node's own `next`. A node of one light is a leaf, its `next` is i + 1; directional lights
/// are leaves beside the tree of the others. Lights that emit nothing are in no node.
///
/// A light's intensity is its own, of one with area radiance x area. Its emission to a direction is
/// the rest: 1 of a point, the cosine of a Lambertian emitter, the cone's factor of a spot.
typedef struct OctreeNode {
    float4 centre;     // xyz: the virtual light's position, the mean by luminance of intensity;
                       // w: radius about it that holds all of all lights
    float4 axis;       // xyz: mean by luminance of emission axes, 0 for a light without cosine;
                       // w: the share of lights without cosine
    float4 cone;       // xyz: unit axis of the cone that holds all emission axes; w: 1 - cosine of
                       // its half angle
    float4 intensity;  // rgb: sum; w: how far before the virtual light shadow rays end
    uint light;        // the first of its lights, its index in the scene
    uint next;         // the node after this one's descendants
    uint emits;        // a set of EMITS_...
    uint count;        // lights
    float inner;       // of spots: 1 - cosine of the smallest angle within which one shines fully
    float outer;       // of spots: 1 - cosine of the largest angle beyond which none shines
    float near_range;  // the largest 1 / range^2, 1/m2; 0 where no light has a range
    float far_range;   // the smallest
} OctreeNode;
SHARED_SIZE(OctreeNode, 96)

/// How lights of a node emit.
#define EMITS_EVENLY 1u  // point lights
#define EMITS_FRONT 2u   // Lambertian emitters
#define EMITS_BOTH 4u    // those of two sides
#define EMITS_CONE 8u    // spots
#define EMITS_AREA 16u   // a light has area

/// Angles by which a node seen from a point is taken to be wider than it is, radians: what rounding
/// may do to directions, some 4 operations of 2^-24 each, and 4 times that. So no light that
/// shines on the point is left out.
#define OCTREE_MARGIN 1e-6f

/// A node whose radius is below this times its distance counts by its virtual light in what errors
/// are relative to. From 1/4 to 1 the cuts of built-in scene rooms change by a fifth, those of city
/// by half, with errors as the sizes: it is no more than another scale of epsilon.
#define OCTREE_SMALL 0.5f

SHARED_END

#endif

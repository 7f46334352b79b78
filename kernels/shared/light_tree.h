// SPDX-License-Identifier: MIT
#ifndef MANYLIGHT_SHARED_LIGHT_TREE_H
#define MANYLIGHT_SHARED_LIGHT_TREE_H

#include "shared/light.h"
#include "shared/types.h"

SHARED_BEGIN

/// A node of a light tree (host/light_tree/): statistics and bounds of the lights first to first +
/// count of the tree's order, world space, metres. Means are weighed by phi, the luminance of the
/// intensity: cd (point, spot, oriented, on the axis where there is one), radiance times area for
/// area lights, lx for directional lights.
///
/// Nodes are in depth-first order: the children of an inner node i are i + 1 and
/// i + 2 * nodes[i + 1].count; a node of one light is a leaf. Where the lights are directional,
/// positions are unit directions to the lights.
typedef struct LightNode {
    float4 centre;     // xyz: mean position; w: mean squared distance to it
    float4 axis;       // xyz: mean emission axis, 0 for a light without one, for a leaf of two
                       // sides the unit normal; w: phi's share of lights without one (emitters of
                       // two sides count with half of theirs)
    float4 intensity;  // rgb: sum; w: radius about the centre that holds all lights
    uint first;
    uint count;
    float reach;    // of a group of spots: the cosine of the largest angle off the mean axis in
                    // which any of them shines, or less; -1: all, as of other nodes
    uint kind;      // of a leaf its LightKind, of an inner node NODE_GROUP or NODE_DIRECTIONS
    float4 lower;   // xyz: bounds; w: 1 - cosine of the bound on the angle between cone and axes
    float4 upper;   // xyz: bounds; w: 1 - cosine of the largest angle off its axis that a light
                    // emits at, at most a right angle; above 1: everywhere
    float4 cone;    // xyz: unit axis of the cone that holds all emission axes; w: sum of power
    float4 unused;  // the first half, all that estimates need, is one line of a cache
} LightNode;
SHARED_SIZE(LightNode, 128)

/// In estimates of groups of spots: 1 / the cosine over which light fades beyond the group's reach.
#define REACH_EDGE 20.0f

#define NODE_GROUP 100
#define NODE_DIRECTIONS 101  // a group of lights that are infinitely far

#define NODE_IS_INFINITE(node) \
    (light_has((node).kind, TRAIT_INFINITE) || (node).kind == NODE_DIRECTIONS)

SHARED_END

#endif

// SPDX-License-Identifier: MIT
#ifndef MANYLIGHT_SHARED_INSTANCE_H
#define MANYLIGHT_SHARED_INSTANCE_H

#include "shared/types.h"

SHARED_BEGIN

/// A place where a mesh stands that is stored once, in a frame of its own. Its triangles have
/// indices of their own, behind those of all that are stored: `first` + k is triangle `stored` + k.
/// In arrays of instances, `first` never decreases.
typedef struct Instance {
    float4 to_world[3];   // rows of the matrix from the mesh's frame to the world; w: its place, m
    float4 to_object[3];  // rows, xyz, of the inverse of its first three columns
    uint first;           // index of its first triangle
    uint stored;          // index of the mesh's first triangle
    uint mesh;            // in Scene::shared_meshes
    uint mirrored;        // 1: it turns the winding of triangles round
    int root;             // the mesh's, among the nodes of a BVH; unset in a scene
    uint padding0;
    uint padding1;
    uint padding2;
} Instance;
SHARED_SIZE(Instance, 128)

/// Children of BVH nodes from here on are instances, by their numbers.
#define INSTANCE_CHILD 0x40000000

SHARED_END

#endif

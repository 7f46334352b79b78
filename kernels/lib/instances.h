// SPDX-License-Identifier: MIT
// Meshes that are stored once and stand in several places (shared/instance.h). Where there are
// none, nothing is left of this.
#ifndef MANYLIGHT_LIB_INSTANCES_H
#define MANYLIGHT_LIB_INSTANCES_H

#include "lib/common.h"
#include "shared/instance.h"

#if HAS_INSTANCES
#define INSTANCE_PARAMETERS , __global const Instance* bvh_instances
#define INSTANCE_ARGUMENTS , bvh_instances

static float3 multiply_rows(__global const float4* rows, float3 v) {
    return (float3)(dot(rows[0].xyz, v), dot(rows[1].xyz, v), dot(rows[2].xyz, v));
}

// By absolute values: how large what multiply_rows() adds up is.
static float3 multiply_sizes(__global const float4* rows, float3 v) {
    return (float3)(dot(fabs(rows[0].xyz), v), dot(fabs(rows[1].xyz), v),
                    dot(fabs(rows[2].xyz), v));
}

static float3 place_of(__global const Instance* in) {
    return (float3)(in->to_world[0].w, in->to_world[1].w, in->to_world[2].w);
}

// Relative to the instance's place first: near it, little is lost by rounding however far it is
// from the world's origin.
static float3 point_to_object(__global const Instance* in, float3 p) {
    return multiply_rows(in->to_object, p - place_of(in));
}

static float3 direction_to_object(__global const Instance* in, float3 d) {
    return multiply_rows(in->to_object, d);
}

static float3 unit_or_none(float3 v) {
    const float squared = dot(v, v);
    return squared > 0.0f ? v / sqrt(squared) : (float3)(0.0f);
}

// From the frame of a triangle's mesh to the world; `in` is null where these are the same.
static float3 point_to_world(__global const Instance* in, float3 p) {
    return in ? multiply_rows(in->to_world, p) + place_of(in) : p;
}

static float3 normal_to_world(__global const Instance* in, float3 n) {
    return in ? unit_or_none(in->to_object[0].xyz * n.x + in->to_object[1].xyz * n.y +
                             in->to_object[2].xyz * n.z)
              : n;
}

static float4 tangent_to_world(__global const Instance* in, float4 t) {
    if (!in) return t;
    return (float4)(unit_or_none(multiply_rows(in->to_world, t.xyz)), in->mirrored ? -t.w : t.w);
}

// The instance that a triangle is of; null: of none.
static __global const Instance* find_instance(__global const Instance* instances, uint count,
                                              uint triangle) {
    if (triangle < instances[0].first) return 0;
    uint low = 0u;
    for (uint high = count; high - low > 1u;) {
        const uint middle = low + (high - low) / 2u;
        if (instances[middle].first <= triangle)
            low = middle;
        else
            high = middle;
    }
    return instances + low;
}
#else
#define INSTANCE_PARAMETERS
#define INSTANCE_ARGUMENTS
#define point_to_world(in, p) (p)
#define normal_to_world(in, n) (n)
#define tangent_to_world(in, t) (t)
#endif

#endif

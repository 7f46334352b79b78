// SPDX-License-Identifier: MIT
// Importance of light tree nodes (shared/light_tree.h) and the descent to one light.
#ifndef MANYLIGHT_LIB_LIGHT_TREE_H
#define MANYLIGHT_LIB_LIGHT_TREE_H

#include "lib/direct.h"
#include "shared/light_tree.h"

// An angle from 0 to pi.
typedef struct Angle {
    float cosine, sine;
} Angle;

static Angle angle_of(float cosine) {
    const Angle angle = {cosine, sqrt(max(1.0f - cosine * cosine, 0.0f))};
    return angle;
}

// That of 1 - cosine, which tells small angles apart.
static Angle angle_of_versine(float versine) {
    const Angle angle = {1.0f - versine, sqrt(versine * (2.0f - versine))};
    return angle;
}

// Between unit vectors.
static Angle angle_between(float3 a, float3 b) {
    const Angle angle = {dot(a, b), length(cross(a, b))};
    return angle;
}

// a - b, or 0 where b is larger.
static Angle less(Angle a, Angle b) {
    Angle difference = {1.0f, 0.0f};
    if (a.cosine >= b.cosine) return difference;
    difference.cosine = a.cosine * b.cosine + a.sine * b.sine;
    difference.sine = a.sine * b.cosine - a.cosine * b.sine;
    return difference;
}

// An upper bound, but for the material, on what a node's lights contribute together: power x
// cosines / squared distance, each as favourable as bounds and cone allow (Conty Estevez and Kulla,
// "Importance Sampling of Many Lights with Adaptive Tree Splitting", 2018, as pbrt-v4 evaluates it
// in LightBounds::Importance). Distances count as the radius of the bounds at least.
static float node_importance(__global const LightNode* node, const Receiver* r) {
    if (NODE_IS_INFINITE(*node)) {
        const float3 c = node->centre.xyz;
        const float cosine = dot(r->normal, c) + node->intensity.w;
        return cosine <= 0.0f ? 0.0f : luminance(node->intensity.xyz) * min(cosine, 1.0f);
    }
    const float3 centre = 0.5f * (node->lower.xyz + node->upper.xyz);
    const float3 half_diagonal = 0.5f * (node->upper.xyz - node->lower.xyz);
    const float radius2 = dot(half_diagonal, half_diagonal);
    const float3 to_centre = centre - r->position;
    const float distance2 = dot(to_centre, to_centre);
    const float floor2 = max(distance2, radius2);
    if (floor2 == 0.0f) return 0.0f;
    const float power = node->cone.w;
    // Within the sphere around the bounds every direction is possible.
    if (distance2 <= radius2) return power / floor2;
    const float3 towards = to_centre / sqrt(distance2);
    const Angle bound = {sqrt(1.0f - radius2 / distance2), sqrt(radius2 / distance2)};
    float emission = 1.0f;
    if (node->upper.w <= 1.0f) {
        const Angle off_axis = less(
            less(angle_between(-node->cone.xyz, towards), angle_of_versine(node->lower.w)), bound);
        emission = off_axis.cosine;
        if (versine_of(off_axis.cosine, off_axis.sine * off_axis.sine) >= node->upper.w)
            return 0.0f;
    }
    const float incidence = less(angle_of(dot(r->normal, towards)), bound).cosine;
    if (incidence <= 0.0f) return 0.0f;
    return power * emission * incidence / floor2;
}

#endif

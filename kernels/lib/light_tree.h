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

// How a surface point sees a node's lights.
typedef struct NodeView {
    // The most favourable cosines, of the normal and of the emission, that bounds and cone allow,
    // multiplied; 0 where none of the lights shines on the point. Of directional lights the
    // normal's alone.
    float cosines;
    float distance2;  // squared, to the centre of the bounds; of finite lights
    float radius2;    // squared, of the sphere around the bounds; of finite lights
} NodeView;

static NodeView view_node(__global const LightNode* node, const Receiver* r) {
    NodeView view = {1.0f, 0.0f, 0.0f};
    if (NODE_IS_INFINITE(*node)) {
        const float cosine = dot(r->normal, node->centre.xyz) + node->intensity.w;
        view.cosines = clamp(cosine, 0.0f, 1.0f);
        return view;
    }
    const float3 centre = 0.5f * (node->lower.xyz + node->upper.xyz);
    const float3 half_diagonal = 0.5f * (node->upper.xyz - node->lower.xyz);
    const float3 to_centre = centre - r->position;
    view.radius2 = dot(half_diagonal, half_diagonal);
    view.distance2 = dot(to_centre, to_centre);
    // Within the sphere around the bounds every direction is possible.
    if (view.distance2 <= view.radius2) return view;
    const float3 towards = to_centre / sqrt(view.distance2);
    const float sine2 = view.radius2 / view.distance2;
    const Angle bound = {sqrt(1.0f - sine2), sqrt(sine2)};
    if (node->upper.w <= 1.0f) {
        const Angle off_axis = less(
            less(angle_between(-node->cone.xyz, towards), angle_of_versine(node->lower.w)), bound);
        view.cosines = off_axis.cosine;
        if (versine_of(off_axis.cosine, off_axis.sine * off_axis.sine) >= node->upper.w)
            view.cosines = 0.0f;
    }
    view.cosines *= max(less(angle_of(dot(r->normal, towards)), bound).cosine, 0.0f);
    return view;
}

// An upper bound, but for the material, on what a node's lights contribute together: power x
// cosines / squared distance, each as favourable as bounds and cone allow (Conty Estevez and Kulla,
// "Importance Sampling of Many Lights with Adaptive Tree Splitting", 2018, as pbrt-v4 evaluates it
// in LightBounds::Importance). Distances count as the radius of the bounds at least.
static float node_importance(__global const LightNode* node, const Receiver* r) {
    const NodeView view = view_node(node, r);
    if (NODE_IS_INFINITE(*node)) return luminance(node->intensity.xyz) * view.cosines;
    const float floor2 = max(view.distance2, view.radius2);
    return floor2 > 0.0f ? node->cone.w * view.cosines / floor2 : 0.0f;
}

#endif

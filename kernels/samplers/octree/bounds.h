// SPDX-License-Identifier: MIT
// Sampler octree: between what values the lights of a node lie, seen from a surface point.
#ifndef MANYLIGHT_SAMPLERS_OCTREE_BOUNDS_H
#define MANYLIGHT_SAMPLERS_OCTREE_BOUNDS_H

#include "lib/direct.h"
#include "lib/light_tree.h"
#include "shared/octree.h"

// Radiance reflected to the camera per intensity, without visibility, 1/(m2 sr): of any light of
// the node, or any of its points, and of the virtual light.
typedef struct Bounds {
    float3 least, most, estimate;
} Bounds;

typedef struct Interval {
    float least, most;
} Interval;

// a + b, or pi where that is less.
static Angle more(Angle a, Angle b) {
    Angle sum = {-1.0f, 0.0f};
    const float sine = a.sine * b.cosine + a.cosine * b.sine;
    if (sine < 0.0f || a.cosine <= -b.cosine) return sum;
    sum.cosine = a.cosine * b.cosine - a.sine * b.sine;
    sum.sine = sine;
    return sum;
}

// Of the cosine's size between two angles.
static Interval cosine_sizes(Angle low, Angle high) {
    const float a = fabs(low.cosine), b = fabs(high.cosine);
    const bool crosses = low.cosine > 0.0f && high.cosine <= 0.0f;
    const Interval sizes = {crosses ? 0.0f : min(a, b), max(a, b)};
    return sizes;
}

// The factor of the lights' emission towards a point that sees the virtual light in direction
// `towards` and all lights within `spread` of that.
static Interval bound_emission(__global const OctreeNode* node, float3 towards, Angle spread) {
    const uint emits = node->emits;
    Interval all = {1.0f, emits & EMITS_EVENLY ? 1.0f : 0.0f};
    if (!(emits & (EMITS_FRONT | EMITS_BOTH | EMITS_CONE))) return all;
    const Angle off_axis = angle_between(-node->cone.xyz, towards);
    const Angle width = more(angle_of_versine(node->cone.w), spread);
    const Angle low = less(off_axis, width), high = more(off_axis, width);
    if (emits & EMITS_FRONT) {
        all.least = max(high.cosine, 0.0f);
        all.most = max(all.most, low.cosine);
    }
    if (emits & EMITS_BOTH) {
        const Interval both = cosine_sizes(low, high);
        all.least = min(all.least, both.least);
        all.most = max(all.most, both.most);
    }
    if (emits & EMITS_CONE) {
        if (versine_of(high.cosine, high.sine * high.sine) > node->inner) all.least = 0.0f;
        if (versine_of(low.cosine, low.sine * low.sine) < node->outer) all.most = 1.0f;
    }
    return all;
}

// That of the virtual light: exact for a light of the mean axis.
static float virtual_emission(__global const OctreeNode* node, float3 towards) {
    const float along = -dot(node->axis.xyz, towards);
    return node->axis.w + (node->emits & EMITS_BOTH ? fabs(along) : max(along, 0.0f));
}

// How much of a light's range, whose inverse square is given, is left at a squared distance
// (lib/lights.h).
static float range_window(float distance2, float inverse_range2) {
    const float ratio = distance2 * inverse_range2;
    return clamp(1.0f - ratio * ratio, 0.0f, 1.0f);
}

#if HAS_GGX
// D V of lib/brdf.h times the cosine `n_in`, which it grows with; the half vector is at an angle to
// the normal.
static float lobe_cosine(float alpha, Angle half_angle, float n_in, float n_out) {
    if (n_in <= 0.0f) return 0.0f;
    const float a2 = alpha * alpha;
    const float width =
        half_angle.sine * half_angle.sine + a2 * half_angle.cosine * half_angle.cosine;
    const float in = 1.0f + sqrt(a2 / (n_in * n_in) + (1.0f - a2));
    const float out = n_out + sqrt(a2 + (1.0f - a2) * n_out * n_out);
    return a2 / (M_PI_F * width * width * in * out);
}

// The BRDF of lib/brdf.h times the cosine, from its parts: `lobe` includes the cosine; `base` and
// `gloss` are Fresnel's terms by Schlick, which take from the diffuse part and give to the lobe.
static float3 reflected(Material m, float cosine, float lobe, float base, float gloss) {
    const float3 diffuse = m.base_color.xyz * (M_1_PI_F * cosine);
    const float metallic = m.base_color.w;
    return (1.0f - metallic) * (diffuse * (1.0f - taken(dielectric_fresnel(m, base))) +
                                lobe * dielectric_fresnel(m, gloss)) +
           metallic * lobe * metal_fresnel(m, gloss);
}

// BRDF x cosine towards all directions within `spread` of `towards`, which is at `incidence` to the
// normal. With `shared`, stage reflections has a part of the lobe that is not known here: from none
// to all of it.
static Bounds bound_lobes(const Receiver* r, float3 towards, Angle incidence, Interval cosine,
                          Angle spread, bool shared) {
    const Material m = r->material;
    const float n_out = max(fabs(dot(r->normal, r->outgoing)), LEAST_COSINE);
    const float3 sum = towards + r->outgoing;
    const float length2 = dot(sum, sum);
    const float3 h = sum / sqrt(max(length2, 1e-12f));
    const Angle difference = angle_between(r->outgoing, h);
    const Angle theta = angle_between(r->normal, h);
    // Half of the spread, and how far the half vector may turn: as half as far in the plane of both
    // directions, and across it 1 / cosine of the difference angle times that.
    const float half_cosine = sqrt(0.5f * (1.0f + spread.cosine));
    const Angle half_spread = {half_cosine, 0.5f * spread.sine / half_cosine};
    const Angle widest = more(difference, half_spread);
    const float turn = half_spread.sine / (half_spread.cosine * max(widest.cosine, 1e-6f));
    Angle low = {1.0f, 0.0f}, high = {0.0f, 1.0f};
    if (turn < 1.0f && length2 > 1e-6f) {
        const Angle by = {sqrt(1.0f - turn * turn), turn};
        low = less(theta, by);
        high = more(theta, by);
    }
    // D falls with the half vector's distance to the normal's line.
    const bool crosses = low.cosine > 0.0f && high.cosine <= 0.0f;
    const Angle across = {0.0f, 1.0f};
    const Angle near = low.sine < high.sine ? low : high;
    const Angle far = crosses ? across : low.sine < high.sine ? high : low;
    const float grazing = schlick(max(widest.cosine, 0.0f));
    const float steep = schlick(less(difference, half_spread).cosine);
    const float most = lobe_cosine(m.roughness, near, cosine.most, n_out);
    const float least = shared ? 0.0f : lobe_cosine(m.roughness, far, cosine.least, n_out);
    const float lobe = shared ? 0.0f : lobe_cosine(m.roughness, theta, incidence.cosine, n_out);
    const float s = schlick(difference.cosine);
    Bounds b;
    b.least = reflected(m, cosine.least, least, grazing, steep);
    b.most = reflected(m, cosine.most, most, steep, grazing);
    b.estimate = reflected(m, max(incidence.cosine, 0.0f), lobe, s, s);
    return b;
}
#endif

// BRDF x cosine towards all directions within `spread` of `towards`; `shared` as above.
static Bounds bound_reflected(const Receiver* r, float3 towards, Angle spread, bool shared) {
    const Angle incidence = angle_between(r->normal, towards);
    const Interval cosine = {max(more(incidence, spread).cosine, 0.0f),
                             max(less(incidence, spread).cosine, 0.0f)};
#if HAS_GGX
    if (r->material.base_color.w > 0.0f || r->material.specular > 0.0f)
        return bound_lobes(r, towards, incidence, cosine, spread, shared);
#endif
    const float3 albedo = r->material.base_color.xyz * M_1_PI_F;
    const Bounds b = {albedo * cosine.least, albedo * cosine.most,
                      albedo * max(incidence.cosine, 0.0f)};
    return b;
}

// Of a node of several lights. Where nothing is known, as the point is among the lights, `most` is
// infinite; where it is 0, no light shines on the point.
static Bounds bound_node(__global const OctreeNode* node, const Receiver* r) {
    const float3 to_centre = node->centre.xyz - r->position;
    const float distance2 = dot(to_centre, to_centre);
    const float distance = sqrt(distance2);
    const float radius = node->centre.w;
    const float sine = radius / distance + OCTREE_MARGIN;
    Bounds b = {(float3)(0.0f), (float3)(INFINITY), (float3)(0.0f)};
    if (!(sine < 1.0f)) return b;
    const float3 towards = to_centre / distance;
    const Angle spread = {sqrt(1.0f - sine * sine), sine};
    // Nothing below the horizon, which may be another plane than the normal's.
    const float height = dot(r->horizon, towards);
    const Interval emission = bound_emission(node, towards, spread);
    if (height <= -sine || emission.most <= 0.0f) {
        b.most = (float3)(0.0f);
        return b;
    }
    const float nearest = distance * (1.0f - sine), farthest = distance * (1.0f + sine);
    const float near2 = nearest * nearest, far2 = farthest * farthest;
    b = bound_reflected(r, towards, spread, r->reflects && (node->emits & EMITS_AREA) != 0u);
    b.least *= height <= sine ? 0.0f : emission.least * range_window(far2, node->near_range) / far2;
    b.most *= emission.most * range_window(near2, node->far_range) / near2;
    const float window = 0.5f * (range_window(distance2, node->near_range) +
                                 range_window(distance2, node->far_range));
    b.estimate *= height <= 0.0f ? 0.0f : virtual_emission(node, towards) * window / distance2;
#if HAS_OUTGOING
    b.least *= r->throughput;
    b.most *= r->throughput;
    b.estimate *= r->throughput;
#endif
    return b;
}

#endif

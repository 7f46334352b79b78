// SPDX-License-Identifier: MIT
// The kinds of light, one function each; only the kinds of the scene at hand are compiled
// (HAS_POINT, HAS_SPOT, ...). Fields: shared/light.h.
#ifndef MANYLIGHT_LIB_LIGHTS_H
#define MANYLIGHT_LIB_LIGHTS_H

#include "lib/common.h"
#include "shared/light.h"

// A light, or a point of it, as a surface point sees it.
typedef struct LightSample {
    float3 direction;   // unit, to the light
    float3 target;      // where the shadow ray ends, unless the light is infinitely far
    float3 emitted;     // Le and the light's part of G: illuminance at normal incidence, lx
    float solid_angle;  // sr, by which `emitted` is Le; 0 for a light without area
    bool infinite;
} LightSample;

static LightSample sample_towards(float3 position, float3 target) {
    LightSample s;
    s.target = target;
    s.direction = target - position;
    s.emitted = (float3)(0.0f);
    s.solid_angle = 0.0f;
    s.infinite = false;
    return s;
}

#if HAS_POINT || HAS_SPOT
// The falloff that KHR_lights_punctual recommends; normalises the direction.
static float punctual_falloff(LightSample* s, float range) {
    const float squared = dot(s->direction, s->direction);
    if (squared == 0.0f) return 0.0f;
    s->direction *= 1.0f / sqrt(squared);
    if (range == 0.0f) return 1.0f / squared;
    const float ratio = squared / (range * range);
    return clamp(1.0f - ratio * ratio, 0.0f, 1.0f) / squared;
}
#endif

#if HAS_POINT
static LightSample light_point(__global const Light* light, float3 position, float2 u) {
    LightSample s = sample_towards(position, light->position.xyz);
    s.emitted = light->emission.xyz * punctual_falloff(&s, light->axis.w);
    return s;
}
#endif

// 1 - cosine, of an angle whose cosine and squared sine these are.
static float versine_of(float cosine, float sine2) {
    return cosine > 0.0f ? sine2 / (1.0f + cosine) : 1.0f - cosine;
}

#if HAS_SPOT
static LightSample light_spot(__global const Light* light, float3 position, float2 u) {
    LightSample s = sample_towards(position, light->position.xyz);
    const float falloff = punctual_falloff(&s, light->axis.w);
    const float3 across = cross(s.direction, light->axis.xyz);
    const float versine = versine_of(-dot(s.direction, light->axis.xyz), dot(across, across));
    const float cone = clamp((light->edge.y - versine) * light->edge.x, 0.0f, 1.0f);
    s.emitted = light->emission.xyz * (falloff * cone * cone);
    return s;
}
#endif

#if HAS_DIRECTIONAL
// Where shadow rays to it end.
static float directional_end(__global const Light* light, float3 origin) {
    if (light->edge.y == 0.0f) return INFINITY;
    return max(dot(light->axis.xyz, origin) - light->edge.x, 1e-30f);  // 0 would be no ray
}

static LightSample light_directional(__global const Light* light, float3 position, float2 u) {
    LightSample s;
    s.direction = -light->axis.xyz;
    s.target = (float3)(0.0f);
    s.emitted = light->emission.xyz;
    s.solid_angle = 0.0f;
    s.infinite = true;
    return s;
}
#endif

#if HAS_ORIENTED || HAS_TRIANGLE || HAS_QUAD
// Intensity I along the normal gives I cos / d^2. `normal` may have any length, which scales;
// shadow rays end `offset` before the emitter. Normalises the direction and returns cos / d^2.
static float emit_cosine(LightSample* s, float3 intensity, float3 normal, float offset,
                         bool both_sides) {
    const float squared = dot(s->direction, s->direction);
    if (squared == 0.0f) return 0.0f;
    s->direction *= 1.0f / sqrt(squared);
    float cosine = -dot(s->direction, normal);
    if (cosine < 0.0f && both_sides) {
        cosine = -cosine;
        normal = -normal;
    }
    if (cosine <= 0.0f) return 0.0f;
    s->emitted = intensity * (cosine / squared);
    const float largest = max(max(fabs(normal.x), fabs(normal.y)), fabs(normal.z));
    s->target += normalize(normal / largest) * offset;  // whose square may be too small for a float
    return cosine / squared;
}
#endif

#if HAS_ORIENTED
static LightSample light_oriented(__global const Light* light, float3 position, float2 u) {
    LightSample s = sample_towards(position, light->position.xyz);
    emit_cosine(&s, light->emission.xyz, light->axis.xyz, light->edge.w, false);
    return s;
}
#endif

#if HAS_TRIANGLE || HAS_QUAD
// The point u of the parallelogram of axis and edge, `share` of which emits; the normal's length is
// the parallelogram's area.
static LightSample light_area(__global const Light* light, float3 position, float2 u, float share) {
    const float3 axis = light->axis.xyz;
    const float3 edge = light->edge.xyz;
    LightSample s = sample_towards(position, light->position.xyz + axis * u.x + edge * u.y);
    s.solid_angle = share * emit_cosine(&s, light->emission.xyz * share, cross(axis, edge),
                                        light->edge.w, light->axis.w != 0.0f);
    return s;
}
#endif

#if HAS_TRIANGLE
static LightSample light_triangle(__global const Light* light, float3 position, float2 u) {
    if (u.x + u.y > 1.0f) u = 1.0f - u;
    return light_area(light, position, u, 0.5f);
}
#endif

#if HAS_QUAD
static LightSample light_quad(__global const Light* light, float3 position, float2 u) {
    return light_area(light, position, u, 1.0f);
}
#endif

// The light, or its point chosen by u in [0, 1)^2, seen from `position`.
static LightSample sample_light(__global const Light* light, float3 position, float2 u) {
    switch ((uint)light->position.w) {
#if HAS_POINT
        case LIGHT_POINT:
            return light_point(light, position, u);
#endif
#if HAS_SPOT
        case LIGHT_SPOT:
            return light_spot(light, position, u);
#endif
#if HAS_DIRECTIONAL
        case LIGHT_DIRECTIONAL:
            return light_directional(light, position, u);
#endif
#if HAS_ORIENTED
        case LIGHT_ORIENTED:
            return light_oriented(light, position, u);
#endif
#if HAS_TRIANGLE
        case LIGHT_TRIANGLE:
            return light_triangle(light, position, u);
#endif
#if HAS_QUAD
        case LIGHT_QUAD:
            return light_quad(light, position, u);
#endif
    }
    LightSample none = sample_towards(position, position);
    return none;
}

// Whether every sample of the light is the same.
static bool is_single_point(__global const Light* light) {
    const uint kind = (uint)light->position.w;
    return kind != LIGHT_TRIANGLE && kind != LIGHT_QUAD;
}

// The u for which sample_light() gives the centroid of a light with area.
static float2 light_centroid(__global const Light* light) {
    return (float2)((uint)light->position.w == LIGHT_TRIANGLE ? 1.0f / 3.0f : 0.5f);
}

#endif

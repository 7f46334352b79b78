// SPDX-License-Identifier: MIT
// What a surface point sees of a light of any kind; lights/ has the kinds, of which only those of
// the scene at hand are compiled (HAS_POINT, HAS_SPOT, ...). Fields: shared/light.h.
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
    float plane;  // if infinite: shadow rays end at dot(-direction, p) = plane
} LightSample;

static LightSample sample_towards(float3 position, float3 target) {
    LightSample s;
    s.target = target;
    s.direction = target - position;
    s.emitted = (float3)(0.0f);
    s.solid_angle = 0.0f;
    s.infinite = false;
    s.plane = 0.0f;
    return s;
}

// 1 - cosine, of an angle whose cosine and squared sine these are.
static float versine_of(float cosine, float sine2) {
    return cosine > 0.0f ? sine2 / (1.0f + cosine) : 1.0f - cosine;
}

#define FOR_RECEIVER 1
#include "lights/kinds.h"
#undef FOR_RECEIVER

// `code`, where the flag is 1, or else nothing.
#define CODE_0(code)
#define CODE_1(code) code
#define CODE_OF(flag, code) CODE_##flag(code)
#define CODE_WHERE(flag, code) CODE_OF(flag, code)

// The light, or its point chosen by u in [0, 1)^2, seen from `position`.
static LightSample sample_light(__global const Light* light, float3 position, float2 u) {
#define LIGHT_CASE(name, NAME, value, traits, centroid) \
    CODE_WHERE(HAS_##NAME, case value : return light_##name(light, position, u);)
    switch ((uint)light->position.w) { LIGHT_KINDS(LIGHT_CASE) }
#undef LIGHT_CASE
    LightSample none = sample_towards(position, position);
    return none;
}

// Whether every sample of the light is the same.
static bool is_single_point(__global const Light* light) {
    return !light_has((uint)light->position.w, TRAIT_AREA);
}

// The u for which sample_light() gives the centroid of a light with area.
static float2 light_centroid(__global const Light* light) {
    const uint kind = (uint)light->position.w;
#define LIGHT_CENTROID(name, NAME, value, traits, centroid) kind == value ? 1.0f / centroid:
    return (float2)(LIGHT_KINDS(LIGHT_CENTROID) 0.5f);
#undef LIGHT_CENTROID
}

#endif

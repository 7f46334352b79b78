// SPDX-License-Identifier: MIT
// Direct illumination of a surface point by one light: V f Le G, paper eq. (1).
#ifndef MANYLIGHT_LIB_DIRECT_H
#define MANYLIGHT_LIB_DIRECT_H

#include "lib/brdf.h"
#include "lib/bvh.h"
#include "lib/lights.h"
#include "lib/view.h"
#include "shared/surface.h"

// A surface point with all that its shading needs.
typedef struct Receiver {
    float3 position;
    float3 normal;
    float3 horizon;
    float3 outgoing;  // unit, where its light goes
#if HAS_OUTGOING
    float3 throughput;
#endif
    float offset;
    bool reflects;  // stage reflections takes part in what the GGX lobe reflects
    Material material;
} Receiver;

static bool surface_missed(__global const Surface* surface) { return surface->position.w < 0.0f; }

static Receiver make_receiver(__global const Surface* surfaces, uint item,
                              __global const Material* materials, View view) {
    __global const Surface* surface = surfaces + item;
    Receiver r;
    r.position = surface->position.xyz;
    r.normal = surface->normal.xyz;
    r.horizon = surface->horizon.xyz;
    r.offset = surface->horizon.w;
#if HAS_OUTGOING
    r.outgoing = view[item].direction.xyz;
    r.throughput = view[item].throughput.xyz;
#else
    r.outgoing = direction_to_camera(view, r.position);
#endif
    r.material = materials[surface->shading];
    r.reflects = false;
#if HAS_REFLECTIONS
    r.reflects = (r.material.base_color.w > 0.0f || r.material.specular > 0.0f) &&
                 r.material.roughness < REFLECTING_ALPHA &&
                 dot(r.normal, r.outgoing) > LEAST_COSINE;
#endif
    return r;
}

// Where shadow rays start.
static float3 shadow_origin(const Receiver* r) { return r->position + r->horizon * r->offset; }

// f Le G times the throughput, cd/m2, of a light (of its point u), without visibility and without
// what is left to stage reflections, where 1 / `weight` light samples are expected on the light; 0
// if the light is behind the surface. `shadow` gets the segment that has to be free.
static float3 unshadowed_weighed(const Receiver* r, __global const Light* light, float2 u,
                                 float weight, Ray* shadow) {
    const LightSample s = sample_light(light, r->position, u);
    const float cosine = dot(r->normal, s.direction);
    if (cosine <= 0.0f || dot(r->horizon, s.direction) <= 0.0f) return (float3)(0.0f);
    shadow->origin = shadow_origin(r);
    shadow->direction = s.infinite ? s.direction : s.target - shadow->origin;
    shadow->end = 1.0f;
#if HAS_INFINITE
    // An end of 0 would be no ray.
    if (s.infinite) shadow->end = max(-dot(s.direction, shadow->origin) - s.plane, 1e-30f);
#endif
    const float3 value = brdf(r->material, r->normal, s.direction, r->outgoing,
                              r->reflects ? s.solid_angle * weight : 0.0f) *
                         s.emitted * cosine;
#if HAS_OUTGOING
    return value * r->throughput;
#else
    return value;
#endif
}

// The same where one light sample is on the light.
static float3 unshadowed(const Receiver* r, __global const Light* light, float2 u, Ray* shadow) {
    return unshadowed_weighed(r, light, u, 1.0f, shadow);
}

#endif

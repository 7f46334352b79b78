// SPDX-License-Identifier: MIT
// Stage reflections: adds what its rays have met by its share, which the light samples leave to it.
//
// Samplers whose light samples have a probability in closed form include this in their files, after
// lib/samples.h; they define CLOSED_FORM and
//
//   static float light_probability(const Receiver* receiver, __global const Light* lights,
//                                  Draw draw, uint light)
//
// with choose_light()'s further parameters: the probability that a light sample is of the light,
// 1 / (N weight) of the choices that choose_light() makes of it, 0 where it makes none. Of the draw
// the item, the first sample and the number of all are known. Where not all N light samples are
// drawn alike, the file defines SAMPLE_ROUND: so many are, one after another; and the probability
// is that of the samples in the draw's round.
#include "lib/brdf.h"
#include "lib/direct.h"
#include "lib/tiles.h"
#include "shared/light_cells.h"
#include "shared/reflected.h"

#if HAS_REFLECTIONS && HAS_GGX

#ifdef CLOSED_FORM
#ifndef SAMPLE_ROUND
#define SAMPLE_ROUND sample_count
#endif

// Veach's heuristic by the number of light samples that are expected on the cell met; of rounds the
// mean by their numbers of samples: each is an estimate of its own.
static float share_of_ray(const Receiver* receiver, __global const Light* lights, uint light_count,
                          uint item, uint light, float ratio,
                          uint sample_count SAMPLER_PARAMETERS) {
    float share = 0.0f;
    const uint full = sample_count - sample_count % SAMPLE_ROUND;  // in rounds that are alike
    for (uint first = 0u, end = full > 0u ? full : sample_count; first < sample_count;
         first = end, end = sample_count) {
        const Draw draw = {item, first, sample_count, (uint4)(0u), light_count};
#ifdef PIXEL_STATE
        PIXEL_STATE state;
        begin_pixel(receiver, lights, draw SAMPLER_ARGUMENTS STATE_ARGUMENT);
#endif
        const float probability =
            light_probability(receiver, lights, draw, light SAMPLER_ARGUMENTS STATE_ARGUMENT);
        // Nothing that is 1e18 times another differs from infinitely many times, and its square is
        // finite.
        const float per_sample = min(ratio / ((float)sample_count * probability), 1e18f);
        share += (float)(end - first) / (float)sample_count * lobe_share(1.0f, per_sample);
    }
    return share;
}
#else
#define SAMPLER_PARAMETERS
#endif

// Adds to estimates[item].rgb, cd/m2.
KERNEL void reflections_add(Tiles tiles, VIEW_PARAMETERS, __global const Surface* surfaces,
                            __global const Material* materials, __global const Light* lights,
                            uint light_count SAMPLER_PARAMETERS, uint sample_count,
                            __global const Reflected* reflected, __global float4* estimates) {
    const uint item = get_global_id(0);
    if (!item_in_image(tiles, item) || surface_missed(surfaces + item)) return;
    const Reflected met = reflected[item];
    if (met.emission.w == 0.0f) return;
#if defined(CLOSED_FORM) || HAS_OUTGOING
    const Receiver receiver = make_receiver(surfaces, item, materials, VIEW);
#endif
#ifdef CLOSED_FORM
    // No light sample is on a cell that is no light.
    const float share = met.light == NO_LIGHT
                            ? 1.0f
                            : share_of_ray(&receiver, lights, light_count, item, met.light,
                                           met.emission.w, sample_count SAMPLER_ARGUMENTS);
#else
    const float share = lobe_share(1.0f, met.emission.w);  // one light sample on each cell
#endif
    const float3 value = met.fresnel.xyz * (met.fresnel.w * share) * met.emission.xyz;
#if HAS_OUTGOING
    estimates[item].xyz += value * receiver.throughput;
#else
    estimates[item].xyz += value;
#endif
}

#endif

// SPDX-License-Identifier: MIT
// Sampler power: probability proportional to the lights' power, one CDF for the whole image.
#include "lib/direct.h"
#include "lib/draw.h"

#define SAMPLER_PARAMETERS , __global const uint* power_cdf
#define SAMPLER_ARGUMENTS , power_cdf
#define CLOSED_FORM

static Choice choose_light(const Receiver* receiver, __global const Light* lights, Draw draw,
                           __global const uint* power_cdf) {
    return draw_from_cdf(power_cdf, draw);
}

static float light_probability(const Receiver* receiver, __global const Light* lights, Draw draw,
                               uint light, __global const uint* power_cdf) {
    return cdf_probability(power_cdf, draw.light_count, light);
}

#include "lib/samples.h"

#include "lib/reflected.h"

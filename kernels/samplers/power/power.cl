// SPDX-License-Identifier: MIT
// Sampler power: probability proportional to the lights' power, one CDF for the whole image.
#include "lib/direct.h"
#include "lib/draw.h"

#define SAMPLER_PARAMETERS , __global const uint* power_cdf
#define SAMPLER_ARGUMENTS , power_cdf

static Choice choose_light(const Receiver* receiver, __global const Light* lights, Draw draw,
                           __global const uint* power_cdf) {
    return draw_from_cdf(power_cdf, draw);
}

#include "lib/samples.h"

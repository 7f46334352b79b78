// SPDX-License-Identifier: MIT
// Sampler power: probability proportional to the lights' power, one CDF for the whole image.
#include "lib/draw.h"

#define SAMPLER_PARAMETERS , __global const uint* power_cdf
#define SAMPLER_ARGUMENTS , power_cdf

static Choice choose_light(uint item, uint sample, uint sample_count, uint random, uint light_count,
                           __global const uint* power_cdf) {
    return draw_from_cdf(power_cdf, light_count, sample, sample_count, random);
}

#include "lib/samples.h"

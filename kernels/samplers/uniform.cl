// SPDX-License-Identifier: MIT
// Sampler uniform: every light has the same probability.
#include "lib/draw.h"

#define SAMPLER_PARAMETERS
#define SAMPLER_ARGUMENTS

static Choice choose_light(uint item, uint sample, uint sample_count, uint random,
                           uint light_count) {
    Choice choice = {stratified_below(light_count, sample, sample_count, random),
                     (float)light_count / (float)sample_count};
    return choice;
}

#include "lib/samples.h"

// SPDX-License-Identifier: MIT
// Sampler exhaustive: all lights, paper eq. (1); sample i is light i.
#include "lib/draw.h"

#define SAMPLER_PARAMETERS
#define SAMPLER_ARGUMENTS

static Choice choose_light(uint item, uint sample, uint sample_count, uint random,
                           uint light_count) {
    Choice choice = {sample, 1.0f};
    return choice;
}

#include "lib/samples.h"

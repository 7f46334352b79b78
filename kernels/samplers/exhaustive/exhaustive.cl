// SPDX-License-Identifier: MIT
// Sampler exhaustive: all lights, paper eq. (1); sample i is light i.
#include "lib/direct.h"
#include "lib/draw.h"

#define SAMPLER_PARAMETERS
#define SAMPLER_ARGUMENTS

static Choice choose_light(const Receiver* receiver, __global const Light* lights, Draw draw) {
    Choice choice = {draw.sample, 1.0f};
    return choice;
}

#include "lib/samples.h"

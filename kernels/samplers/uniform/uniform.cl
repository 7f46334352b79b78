// SPDX-License-Identifier: MIT
// Sampler uniform: every light has the same probability.
#include "lib/direct.h"
#include "lib/draw.h"

#define SAMPLER_PARAMETERS
#define SAMPLER_ARGUMENTS
#define CLOSED_FORM

static Choice choose_light(const Receiver* receiver, __global const Light* lights, Draw draw) {
    Choice choice = {
        stratified_below(draw.light_count, draw.sample, draw.sample_count, draw.bits.x),
        (float)draw.light_count / (float)draw.sample_count};
    return choice;
}

static float light_probability(const Receiver* receiver, __global const Light* lights, Draw draw,
                               uint light) {
    return 1.0f / (float)draw.light_count;
}

#include "lib/samples.h"

#include "lib/reflected.h"

// SPDX-License-Identifier: MIT
// Samplers contribution and contribution-defensive: the CDF of the pixel's cluster (paper 4.2).
#include "lib/direct.h"
#include "lib/draw.h"

// cdf[item_rows[item] * light_count + light]
#define SAMPLER_PARAMETERS , __global const uint *cdf, __global const uint *item_rows
#define SAMPLER_ARGUMENTS , cdf, item_rows
#define CLOSED_FORM

static Choice choose_light(const Receiver* receiver, __global const Light* lights, Draw draw,
                           __global const uint* cdf, __global const uint* item_rows) {
    return draw_from_cdf(cdf + (ulong)item_rows[draw.item] * draw.light_count, draw);
}

static float light_probability(const Receiver* receiver, __global const Light* lights, Draw draw,
                               uint light, __global const uint* cdf,
                               __global const uint* item_rows) {
    return cdf_probability(cdf + (ulong)item_rows[draw.item] * draw.light_count, draw.light_count,
                           light);
}

#include "lib/samples.h"

#include "lib/reflected.h"

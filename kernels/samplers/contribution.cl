// SPDX-License-Identifier: MIT
// Samplers contribution and contribution-defensive: the CDF of the pixel's cluster (paper 4.2).
#include "lib/draw.h"

// cdf[item_rows[item] * light_count + light]
#define SAMPLER_PARAMETERS , __global const uint *cdf, __global const uint *item_rows
#define SAMPLER_ARGUMENTS , cdf, item_rows

static Choice choose_light(uint item, uint sample, uint sample_count, uint random, uint light_count,
                           __global const uint* cdf, __global const uint* item_rows) {
    return draw_from_cdf(cdf + (ulong)item_rows[item] * light_count, light_count, sample,
                         sample_count, random);
}

#include "lib/samples.h"

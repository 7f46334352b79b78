// SPDX-License-Identifier: MIT
// Drawing light samples from a distribution.
#ifndef MANYLIGHT_LIB_DRAW_H
#define MANYLIGHT_LIB_DRAW_H

#include "lib/common.h"

// Which light sample is to be drawn, from 128 random bits.
typedef struct Draw {
    uint item;
    uint sample, sample_count;
    uint4 bits;  // y and z are the point on a light with area
    uint light_count;
} Draw;

// A light sample: which light, and 1 / (N p) of eq. (2); weight 0 means none.
typedef struct Choice {
    uint light;
    float weight;
} Choice;

// An integer below `total` for sample i of n: stratified, uniform over the n samples.
static uint stratified_below(uint total, uint i, uint n, uint random) {
    return (uint)(((ulong)i * total + mul_hi(random, total)) / n);
}

// The light at `target`, which is below the total, of a CDF (kernels/pdf.cl).
static uint search_cdf(__global const uint* cdf, uint light_count, uint target) {
    // The first light whose running sum exceeds the target lies in first..first + count - 1. As
    // many steps for every target, and no branch that depends on it.
    uint first = 0u;
    for (uint count = light_count; count > 1u;) {
        const uint half_count = count / 2u;
        first += cdf[first + half_count - 1u] <= target ? half_count : 0u;
        count -= half_count;
    }
    return first;
}

static uint cdf_width(__global const uint* cdf, uint light) {
    return cdf[light] - (light == 0u ? 0u : cdf[light - 1u]);
}

static float cdf_probability(__global const uint* cdf, uint light_count, uint light) {
    const uint total = cdf[light_count - 1u];
    return total == 0u ? 0.0f : (float)cdf_width(cdf, light) / (float)total;
}

static Choice draw_from_cdf(__global const uint* cdf, Draw draw) {
    Choice choice = {0u, 0.0f};
    const uint total = cdf[draw.light_count - 1u];
    if (total == 0u) return choice;
    const uint target = stratified_below(total, draw.sample, draw.sample_count, draw.bits.x);
    choice.light = search_cdf(cdf, draw.light_count, target);
    const float width = (float)cdf_width(cdf, choice.light);
    choice.weight = (float)total / (width * (float)draw.sample_count);
    return choice;
}

#endif

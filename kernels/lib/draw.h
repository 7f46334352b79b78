// SPDX-License-Identifier: MIT
// Drawing light samples from a distribution.
#ifndef MANYLIGHT_LIB_DRAW_H
#define MANYLIGHT_LIB_DRAW_H

#include "lib/common.h"

// A light sample: which light, and 1 / (N p) of eq. (2); weight 0 means none.
typedef struct Choice {
    uint light;
    float weight;
} Choice;

// An integer below `total` for sample i of n: stratified, uniform over the n samples.
static uint stratified_below(uint total, uint i, uint n, uint random) {
    return (uint)(((ulong)i * total + mul_hi(random, total)) / n);
}

// Sample i of n from a CDF (kernels/pdf.cl).
static Choice draw_from_cdf(__global const uint* cdf, uint light_count, uint i, uint n,
                            uint random) {
    Choice choice = {0u, 0.0f};
    const uint total = cdf[light_count - 1u];
    if (total == 0u) return choice;
    const uint target = stratified_below(total, i, n, random);
    // The first light whose running sum exceeds the target lies in first..first + count - 1. As
    // many steps for every target, and no branch that depends on it.
    uint first = 0u;
    for (uint count = light_count; count > 1u;) {
        const uint half_count = count / 2u;
        first += cdf[first + half_count - 1u] <= target ? half_count : 0u;
        count -= half_count;
    }
    const uint width = cdf[first] - (first == 0u ? 0u : cdf[first - 1u]);
    choice.light = first;
    choice.weight = (float)total / ((float)width * (float)n);
    return choice;
}

#endif

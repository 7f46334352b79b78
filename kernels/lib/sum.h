// SPDX-License-Identifier: MIT
#ifndef MANYLIGHT_LIB_SUM_H
#define MANYLIGHT_LIB_SUM_H

#include "lib/common.h"

// Adds a term to a sum of many (Kahan, "Further remarks on reducing truncation errors", 1965): the
// residual holds what rounding added too much, so that a million small terms are not lost beside a
// large one.
static void add_compensated(float4* sum, float4* residual, float4 term) {
    const float4 corrected = term - *residual;
    const float4 next = *sum + corrected;
    *residual = (next - *sum) - corrected;
    *sum = next;
}

// The same of single numbers.
static void add_compensated_1(float* sum, float* residual, float term) {
    const float corrected = term - *residual;
    const float next = *sum + corrected;
    *residual = (next - *sum) - corrected;
    *sum = next;
}

#endif

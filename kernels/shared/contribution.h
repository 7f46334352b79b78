// SPDX-License-Identifier: MIT
#ifndef MANYLIGHT_SHARED_CONTRIBUTION_H
#define MANYLIGHT_SHARED_CONTRIBUTION_H

#include "shared/types.h"

SHARED_BEGIN

/// Sums over a row of the contribution matrix, or over a chunk of LIGHT_CHUNK lights of it.
typedef struct RowSum {
    float visible;       // sum of C(a, y), cd/m2 (luminance)
    float unshadowed;    // the same with V = 1
    uint visible_count;  // lights with C(a, y) > 0
    uint facing_count;   // lights that would contribute if nothing were in between
} RowSum;
SHARED_SIZE(RowSum, 16)

/// Rows are summed and scanned in chunks of this many lights, one work-item each.
#define LIGHT_CHUNK 256

/// How a row of weights is mixed before it becomes a PDF; the shares need not sum to 1.
typedef struct Mixture {
    float visible;      // share of C(a, y), the paper's eq. (6)
    float unshadowed;   // share of C(a, y) with V = 1
    float power;        // share of the lights' power
    float total_power;  // sum of the lights' power, lm
} Mixture;
SHARED_SIZE(Mixture, 16)

/// A CDF counts in integers: each light has a width of its probability times this, rounded down but
/// at least 1 where the probability is positive. So a row's total stays below 2^32 for up to 2^31
/// lights, every sum is exact, and the probability of a draw is width / total but for the rounding
/// of 1 / p to a float.
#define CDF_SCALE 2147483648.0f

SHARED_END

#endif

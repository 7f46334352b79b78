// SPDX-License-Identifier: MIT
// Reciprocals and roots of LANES numbers within a few roundings. Where registers have 16 lanes,
// exact ones would take most of the time of what they are used in.
#ifndef MANYLIGHT_LIB_INVERSE_H
#define MANYLIGHT_LIB_INVERSE_H

#include "lib/lanes.h"

#if LANES == 16 && defined(__AVX512F__) && !defined(PORTABLE_LANES)
#define APPROXIMATE_INVERSE 1
#else
#define APPROXIMATE_INVERSE 0
#endif

// 1 / x, of numbers from 1e-30 to 1e30.
INLINE float_n inverse_n(float_n x) {
#if APPROXIMATE_INVERSE
    const float_n r = __builtin_ia32_rcp14ps512_mask(x, x, (ushort)0xffffu);
    return fma(r, fma(-x, r, 1.0f), r);
#else
    return 1.0f / x;
#endif
}

// 1 / sqrt(x), of the same.
INLINE float_n inverse_root_n(float_n x) {
#if APPROXIMATE_INVERSE
    const float_n r = __builtin_ia32_rsqrt14ps512_mask(x, x, (ushort)0xffffu);
    return fma(0.5f * r, fma(-x * r, r, 1.0f), r);
#else
    return 1.0f / sqrt(x);
#endif
}

// sqrt(x), of numbers from 0 to 1e30.
INLINE float_n root_n(float_n x) { return x * inverse_root_n(max(x, 1e-30f)); }

static float inverse_1(float x) { return 1.0f / x; }
static float inverse_root_1(float x) { return 1.0f / sqrt(x); }
static float root_1(float x) { return sqrt(x); }

#endif

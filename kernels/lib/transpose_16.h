// SPDX-License-Identifier: MIT
// Moving numbers between the lanes of vectors: 16 structures of 16 numbers are loaded as rows.
#ifndef MANYLIGHT_LIB_TRANSPOSE_16_H
#define MANYLIGHT_LIB_TRANSPOSE_16_H

// a and b in turns: of their first, and of their second halves.
static float16 zip_low(float16 a, float16 b) {
    return (float16)(a.s0, b.s0, a.s1, b.s1, a.s2, b.s2, a.s3, b.s3, a.s4, b.s4, a.s5, b.s5, a.s6,
                     b.s6, a.s7, b.s7);
}

static float16 zip_high(float16 a, float16 b) {
    return (float16)(a.s8, b.s8, a.s9, b.s9, a.sa, b.sa, a.sb, b.sb, a.sc, b.sc, a.sd, b.sd, a.se,
                     b.se, a.sf, b.sf);
}

// Turns rows to columns. Each round moves the top bit of the row's number below the column's.
static void transpose_16(float16* rows) {
    float16 zipped[16];
    for (uint round = 0u; round < 2u; ++round) {
        for (uint i = 0u; i < 8u; ++i) {
            zipped[2u * i] = zip_low(rows[i], rows[i + 8u]);
            zipped[2u * i + 1u] = zip_high(rows[i], rows[i + 8u]);
        }
        for (uint i = 0u; i < 8u; ++i) {
            rows[2u * i] = zip_low(zipped[i], zipped[i + 8u]);
            rows[2u * i + 1u] = zip_high(zipped[i], zipped[i + 8u]);
        }
    }
}

// Lanes `lanes` of v.
static float16 permute_16(float16 v, uint16 lanes) {
#if defined(__AVX512F__) && !defined(PORTABLE_LANES)
    return __builtin_ia32_permvarsf512(v, as_int16(lanes));
#else
    return shuffle(v, lanes);
#endif
}

#endif

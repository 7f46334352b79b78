// SPDX-License-Identifier: MIT
// Vectors of LANES numbers, as many as a device's registers hold; where LANES is 1, plain numbers,
// for devices that run a work-item in each lane themselves (GPUs).
//
// Comparisons of vectors give -1 where they hold, of plain numbers 1: conditions are combined by
// & | and !, never by ~, and are chosen by with select().
#ifndef MANYLIGHT_LIB_LANES_H
#define MANYLIGHT_LIB_LANES_H

// Functions of OpenCL's own take them by value, too; drivers inline these.
#if defined(__clang__)
#pragma clang diagnostic ignored "-Wpsabi"
#endif

// For functions that take vectors by value, which some registers are too small for. A plain number
// fits: there the compiler chooses (and Oclgrind can run what it leaves alone).
#if LANES == 1
#define INLINE static inline
#else
#define INLINE static inline __attribute__((always_inline))
#endif

#define JOIN_TOKENS(a, b) a##b
#define JOIN(a, b) JOIN_TOKENS(a, b)

#if LANES == 1
#define OF_LANES(name) name
#else
#define OF_LANES(name) JOIN(name, LANES)
#endif
typedef OF_LANES(float) float_n;
typedef OF_LANES(int) int_n;
typedef OF_LANES(uint) uint_n;
// At a pointer to numbers in global memory that is aligned to as many; vloadN() allows for others.
#define FLOATS_AT(pointer) (*(__global const float_n*)(pointer))
#define UINTS_AT(pointer) (*(__global const uint_n*)(pointer))
#define as_float_n OF_LANES(as_float)
#define as_int_n OF_LANES(as_int)
#define as_uint_n OF_LANES(as_uint)
#define convert_float_n OF_LANES(convert_float)
#define convert_int_n OF_LANES(convert_int)

// A set of lanes as one integer, a bit per lane: lanes_N(comparison), lowest(set).
#if defined(__AVX512DQ__) && defined(__AVX512VL__) && !defined(PORTABLE_LANES)
#define lanes_4(comparison) (uint)(uchar) __builtin_ia32_cvtd2mask128(comparison)
#define lanes_8(comparison) (uint)(uchar) __builtin_ia32_cvtd2mask256(comparison)
#define lanes_16(comparison) (uint)(ushort) __builtin_ia32_cvtd2mask512(comparison)
#else
#if defined(__AVX__) && !defined(PORTABLE_LANES)
#define lanes_8(comparison) (uint) __builtin_ia32_movmskps256(as_float8(comparison))
#else
// PoCL turns these conversions of a comparison into one mask move; any() becomes branches. The
// product gathers the lowest bits of eight bytes in its highest byte.
INLINE uint lanes_8(int8 comparison) {
    const ulong bytes = as_ulong(convert_char8(comparison)) & 0x0101010101010101ul;
    return (uint)((bytes * 0x0102040810204080ul) >> 56);
}
#endif
#if defined(__SSE2__) && !defined(PORTABLE_LANES)
#define lanes_4(comparison) (uint) __builtin_ia32_movmskps(as_float4(comparison))
#else
INLINE uint lanes_4(int4 comparison) {
    const uint bytes = as_uint(convert_char4(comparison)) & 0x01010101u;
    return (bytes * 0x01020408u) >> 24;
}
#endif
#define lanes_16(comparison) lanes_of_halves((comparison).lo, (comparison).hi)
INLINE uint lanes_of_halves(int8 low, int8 high) { return lanes_8(low) | (lanes_8(high) << 8); }
#endif
#define lanes_1(comparison) ((comparison) ? 1u : 0u)
#define lanes_n JOIN(lanes_, LANES)
#define ALL_LANES ((1u << LANES) - 1u)

// The lowest lane of a set; OpenCL C 1.2 has clz but not ctz.
static uint lowest(uint lanes) { return 31u - (uint)clz(lanes & (0u - lanes)); }

#define LANE(vector, lane) (((const float*)&(vector))[lane])
#define SET_LANE(vector, lane, value) ((float*)&(vector))[lane] = (value)
#define INT_LANE(vector, lane) (((int*)&(vector))[lane])
#define UINT_LANE(vector, lane) (((uint*)&(vector))[lane])

// The number of each lane, the least number, the sum, and lanes `lanes` of a vector.
#if LANES == 16
INLINE int_n lane_numbers(void) {
    return (int_n)(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
}
INLINE float lowest_of(float_n v) {
    const float8 a = min(v.lo, v.hi);
    const float4 b = min(a.lo, a.hi);
    const float2 c = min(b.lo, b.hi);
    return min(c.x, c.y);
}
INLINE float sum_of(float_n v) {
    const float8 a = v.lo + v.hi;
    const float4 b = a.lo + a.hi;
    return b.x + b.y + (b.z + b.w);
}
#elif LANES == 8
INLINE int_n lane_numbers(void) { return (int_n)(0, 1, 2, 3, 4, 5, 6, 7); }
INLINE float lowest_of(float_n v) {
    const float4 a = min(v.lo, v.hi);
    const float2 b = min(a.lo, a.hi);
    return min(b.x, b.y);
}
INLINE float sum_of(float_n v) {
    const float4 a = v.lo + v.hi;
    return a.x + a.y + (a.z + a.w);
}
#elif LANES == 4
INLINE int_n lane_numbers(void) { return (int_n)(0, 1, 2, 3); }
INLINE float lowest_of(float_n v) {
    const float2 a = min(v.lo, v.hi);
    return min(a.x, a.y);
}
INLINE float sum_of(float_n v) { return v.x + v.y + (v.z + v.w); }
#elif LANES == 1
INLINE int_n lane_numbers(void) { return 0; }
INLINE float sum_of(float_n v) { return v; }
#endif

#if LANES == 1
#define permute_n(v, lanes) (v)
#elif LANES == 16 && defined(__AVX512F__) && !defined(PORTABLE_LANES)
#define permute_n(v, lanes) __builtin_ia32_permvarsf512(v, as_int16(lanes))
#elif LANES == 8 && defined(__AVX2__) && !defined(PORTABLE_LANES)
#define permute_n(v, lanes) __builtin_ia32_permvarsf256(v, as_int8(lanes))
#else
#define permute_n(v, lanes) shuffle(v, lanes)
#endif

// a and b in turns: of their first, and of their second halves.
#if LANES == 16
INLINE float_n zip_low(float_n a, float_n b) {
    return (float_n)(a.s0, b.s0, a.s1, b.s1, a.s2, b.s2, a.s3, b.s3, a.s4, b.s4, a.s5, b.s5, a.s6,
                     b.s6, a.s7, b.s7);
}
INLINE float_n zip_high(float_n a, float_n b) {
    return (float_n)(a.s8, b.s8, a.s9, b.s9, a.sa, b.sa, a.sb, b.sb, a.sc, b.sc, a.sd, b.sd, a.se,
                     b.se, a.sf, b.sf);
}
#elif LANES == 8
INLINE float_n zip_low(float_n a, float_n b) {
    return (float_n)(a.s0, b.s0, a.s1, b.s1, a.s2, b.s2, a.s3, b.s3);
}
INLINE float_n zip_high(float_n a, float_n b) {
    return (float_n)(a.s4, b.s4, a.s5, b.s5, a.s6, b.s6, a.s7, b.s7);
}
#elif LANES == 4
INLINE float_n zip_low(float_n a, float_n b) { return (float_n)(a.s0, b.s0, a.s1, b.s1); }
INLINE float_n zip_high(float_n a, float_n b) { return (float_n)(a.s2, b.s2, a.s3, b.s3); }
#endif

#if LANES > 1
INLINE void zip_rows(const float_n* rows, float_n* zipped) {
    for (uint i = 0u; i < LANES / 2u; ++i) {
        zipped[2u * i] = zip_low(rows[i], rows[i + LANES / 2u]);
        zipped[2u * i + 1u] = zip_high(rows[i], rows[i + LANES / 2u]);
    }
}

// Turns the rows of a square to columns: each zip moves the top bit of the row's number below the
// column's.
INLINE void transpose(float_n* rows) {
    float_n zipped[LANES];
    zip_rows(rows, zipped);
    zip_rows(zipped, rows);
#if LANES == 8
    zip_rows(rows, zipped);
    for (uint i = 0u; i < LANES; ++i) rows[i] = zipped[i];
#elif LANES == 16
    zip_rows(rows, zipped);
    zip_rows(zipped, rows);
#endif
}
#endif

// The first 16 numbers of the lanes' structures, one by one: columns[k] gets number k of all.
// `structures` has structures of `size` numbers.
INLINE void load_columns(__global const float* structures, uint size, uint_n indices,
                         float_n* columns) {
#if LANES == 1
    for (uint k = 0u; k < 16u; ++k) columns[k] = structures[(ulong)size * indices + k];
#else
    for (uint lane = 0u; lane < LANES; ++lane) {
        __global const float* own = structures + (ulong)size * UINT_LANE(indices, lane);
        for (uint k = 0u; k < 16u / LANES; ++k)
            columns[k * LANES + lane] = FLOATS_AT(own + k * LANES);
    }
    for (uint k = 0u; k < 16u / LANES; ++k) transpose(columns + k * LANES);
#endif
}

#endif

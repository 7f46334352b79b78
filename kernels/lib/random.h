// SPDX-License-Identifier: MIT
// Random numbers by counter: the same pixel, sample and seed give the same numbers on any device.
#ifndef MANYLIGHT_LIB_RANDOM_H
#define MANYLIGHT_LIB_RANDOM_H

#include "lib/common.h"
#include "lib/lanes.h"

// Four uniform 32-bit integers: pcg4d of Jarzynski and Olano, "Hash Functions for GPU Rendering"
// (JCGT 9:3, 2020).
static uint4 random_bits(uint pixel, uint pixel_sample, uint dimension, uint seed) {
    uint4 v = (uint4)(pixel, pixel_sample, dimension, seed) * 1664525u + 1013904223u;
    v.x += v.y * v.w;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    v.w += v.y * v.z;
    v ^= v >> 16u;
    v.x += v.y * v.w;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    v.w += v.y * v.z;
    return v;
}

// The same for LANES pixels and dimensions: v[0] to v[3].
INLINE void random_bits_n(uint_n pixels, uint pixel_sample, uint_n dimensions, uint seed,
                          uint_n* v) {
    v[0] = pixels * 1664525u + 1013904223u;
    v[1] = (uint_n)(pixel_sample * 1664525u + 1013904223u);
    v[2] = dimensions * 1664525u + 1013904223u;
    v[3] = (uint_n)(seed * 1664525u + 1013904223u);
    for (uint round = 0u; round < 2u; ++round) {
        v[0] += v[1] * v[3];
        v[1] += v[2] * v[0];
        v[2] += v[0] * v[1];
        v[3] += v[1] * v[2];
        if (round == 0u)
            for (uint i = 0u; i < 4u; ++i) v[i] ^= v[i] >> 16u;
    }
}

// 32 bits for step i of what starts with 32 random bits: pcg_hash of the same paper.
static uint step_bits(uint bits, uint i) {
    const uint state = (bits + i * 0x9e3779b9u) * 747796405u + 2891336453u;
    const uint word = ((state >> ((state >> 28) + 4u)) ^ state) * 277803737u;
    return (word >> 22) ^ word;
}

// The same for LANES.
INLINE uint_n step_bits_n(uint_n bits, uint i) {
    const uint_n state = (bits + i * 0x9e3779b9u) * 747796405u + 2891336453u;
    const uint_n word = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
    return (word >> 22u) ^ word;
}

// The dimension that seeds the position of a pixel's samples; light samples use their own index.
#define RANDOM_PIXEL_POSITION 0xffffffffu
// The dimensions of one pass of sampler adaptive.
#define RANDOM_DRAWS 1024u
// The dimension that shifts the systematic draws of a pass.
#define RANDOM_DRAW_SHIFT 0xfffffffdu

// The dimension that seeds the directions of stage reflections.
#define RANDOM_REFLECTION 0xfffffffcu

// The dimension that seeds the points of stage emitter_parts.
#define RANDOM_EMITTER 0xfffffffbu

// A float in [0, 1) from the top 24 bits.
static float unit_float(uint bits) { return (float)(bits >> 8) * 0x1p-24f; }

INLINE float_n unit_float_n(uint_n bits) { return convert_float_n(bits >> 8u) * 0x1p-24f; }

static uint reverse_bits(uint v) {
    v = (v >> 16) | (v << 16);
    v = ((v >> 8) & 0x00ff00ffu) | ((v & 0x00ff00ffu) << 8);
    v = ((v >> 4) & 0x0f0f0f0fu) | ((v & 0x0f0f0f0fu) << 4);
    v = ((v >> 2) & 0x33333333u) | ((v & 0x33333333u) << 2);
    return ((v >> 1) & 0x55555555u) | ((v & 0x55555555u) << 1);
}

// Nested uniform scrambling of a base-2 digit sequence: Burley, "Practical Hash-based Owen
// Scrambling" (JCGT 9:4, 2020).
static uint owen_scramble(uint v, uint seed) {
    v = reverse_bits(v);
    v += seed;
    v ^= v * 0x6c50b47cu;
    v ^= v * 0xb82f1e52u;
    v ^= v * 0xc7afe638u;
    v ^= v * 0x8d22f6e6u;
    return reverse_bits(v);
}

// Point `index`, in [0, 1)^2, of the first two dimensions of Sobol's sequence, Owen-scrambled.
static float2 sobol_point(uint index, uint2 scramble) {
    uint y = 0u;
    uint direction = 0x80000000u;
    for (uint i = index; i != 0u; i >>= 1) {
        if (i & 1u) y ^= direction;
        direction ^= direction >> 1;
    }
    return (float2)(unit_float(owen_scramble(reverse_bits(index), scramble.x)),
                    unit_float(owen_scramble(y, scramble.y)));
}

// Where in its pixel a pixel sample lies, in [0, 1)^2; every power of two of samples is stratified.
static float2 pixel_position(uint pixel, uint pixel_sample, uint seed) {
    return sobol_point(pixel_sample, random_bits(pixel, 0u, RANDOM_PIXEL_POSITION, seed).xy);
}

// The numbers, in [0, 1)^2, that a pixel sample's reflected direction is drawn from. Stratified
// likewise, but in an order of its own (Burley's shuffling), independent of the position's.
static float2 reflection_point(uint pixel, uint pixel_sample, uint seed) {
    const uint4 bits = random_bits(pixel, 0u, RANDOM_REFLECTION, seed);
    return sobol_point(owen_scramble(pixel_sample, bits.z), bits.xy);
}

#endif

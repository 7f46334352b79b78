// SPDX-License-Identifier: MIT
// What the kernels of samplers ward and ward-unbiased share: the walk down a pixel's lights.
//
// They work on a slice of a batch: slot i is item first_item + i. Buffers over slots and lights:
//   contributions[slot * light_count + light]: rgb, cd/m2, of the light (of its point) where
//     nothing is in its way; w, its luminance, 0 once the light is tested;
//   order[slot * light_count + i]: entries of lights with a contribution, those in front a heap
//     whose first is the largest, those behind in descending order from the end: the walk takes
//     them in turn.
// Buffers over slots:
//   walks[slot]: the sum that the stopping rule looks at, its residual (lib/sum.h); of the lights
//     tested, how many were expected to be visible, and how many are;
//   counts[slot]: lights with a contribution; those tested, those of the step included; those in
//     descending order; rays of the step, in packets slot * STEP_PACKETS on.
#ifndef MANYLIGHT_SAMPLERS_WARD_WALK_H
#define MANYLIGHT_SAMPLERS_WARD_WALK_H

#include "lib/direct.h"
#include "lib/random.h"
#include "lib/rays.h"
#include "lib/sum.h"
#include "lib/tiles.h"
#include "shared/ward.h"

// Where a slot's lights begin in arrays over slots and lights.
static ulong slot_lights(uint slot, uint light_count) { return (ulong)slot * light_count; }

// A slot's entries of the order, which the host holds as pairs.
static __global ulong* slot_order(__global uint2* order, uint slot, uint light_count) {
    return (__global ulong*)order + slot_lights(slot, light_count);
}

// An entry of the order: the larger contribution first, of equal ones the earlier light.
static ulong entry_of(float size, uint light) { return (ulong)as_uint(size) << 32 | ~light; }
static float entry_size(ulong entry) { return as_float((uint)(entry >> 32)); }
static uint entry_light(ulong entry) { return ~(uint)entry; }

// The hit histories of an item's tile.
static __global const uint* item_histories(Tiles tiles, uint item, __global const uint* histories,
                                           uint light_count) {
    return histories + (ulong)(item / (tiles.size * tiles.size)) * light_count;
}

// The share of a light's shadow rays that pass, by its history: Laplace's rule of succession.
static float history_share(uint history) {
    return ((float)(history >> 16) + 1.0f) / ((float)(history & 0xffffu) + 2.0f);
}

// The expected visibility of a light that was not tested: its history, times the hits at this point
// over those that the histories of the lights tested let expect.
static float expected_visibility(float4 walk, uint history) {
    const float ratio = walk.z > 0.0f ? walk.w / walk.z : 0.0f;
    return min(history_share(history) * ratio, 1.0f);
}

// The light's point that a pixel sample sees: the same as sampler exhaustive's.
static float2 point_of_light(__global const Light* light, uint index, uint pixel, uint pixel_sample,
                             uint seed) {
    if (is_single_point(light)) return (float2)(0.0f);
    const uint4 bits = random_bits(pixel, pixel_sample, index, seed);
    return (float2)(unit_float(bits.y), unit_float(bits.z));
}

#endif

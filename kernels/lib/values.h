// SPDX-License-Identifier: MIT
// What rays bring: values[48 * packet + 16 * channel + lane], cd/m2, where nothing is in the way.
#ifndef MANYLIGHT_LIB_VALUES_H
#define MANYLIGHT_LIB_VALUES_H

#include "lib/rays.h"
#include "lib/sum.h"

// Adds the values of a packet's rays that passed to rgb, and the number of its rays to w.
static void add_values(__global const float* rays, __global const float* values, uint packet,
                       float4* sum, float4* residual) {
    __global const float* lanes = values + 48 * (ulong)packet;
    for (uint lane = 0u; lane < 16u; ++lane) {
        const float end = RAY_END(rays, packet, lane);
        if (end == 0.0f) break;
        const float3 value = end > 0.0f
                                 ? (float3)(lanes[lane], lanes[lane + 16u], lanes[lane + 32u])
                                 : (float3)(0.0f);
        add_compensated(sum, residual, (float4)(value, 1.0f));
    }
}

#endif

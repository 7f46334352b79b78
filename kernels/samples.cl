// SPDX-License-Identifier: MIT
// Stage samples: adds up what lib/samples.h drew and stage shadows traced.
#include "lib/rays.h"
#include "lib/sum.h"
#include "lib/tiles.h"

// Adds the visible values to estimates[item].rgb, cd/m2, and the number of rays to its w; `start`
// starts the sums, to which residuals[item] belongs (lib/sum.h).
KERNEL void samples_add(Tiles tiles, __global const float* rays, __global const float* values,
                        uint start, __global float4* estimates, __global float4* residuals) {
    const uint item = get_global_id(0);
    if (!item_in_image(tiles, item)) return;
    float4 sum = start ? (float4)(0.0f) : estimates[item];
    float4 residual = start ? (float4)(0.0f) : residuals[item];
    __global const float* lanes = values + 48 * (ulong)item;
    for (uint lane = 0u; lane < 16u; ++lane) {
        const float end = RAY_END(rays, item, lane);
        if (end == 0.0f) break;
        const float3 value = end > 0.0f
                                 ? (float3)(lanes[lane], lanes[lane + 16u], lanes[lane + 32u])
                                 : (float3)(0.0f);
        add_compensated(&sum, &residual, (float4)(value, 1.0f));
    }
    estimates[item] = sum;
    residuals[item] = residual;
}

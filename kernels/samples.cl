// SPDX-License-Identifier: MIT
// Stage samples: adds up what lib/samples.h drew and stage shadows traced.
#include "lib/tiles.h"
#include "lib/values.h"

// Adds the visible values to estimates[item].rgb, cd/m2, and the number of rays to its w; `start`
// starts the sums, to which residuals[item] belongs (lib/sum.h).
KERNEL void samples_add(Tiles tiles, __global const float* rays, __global const float* values,
                        uint start, __global float4* estimates, __global float4* residuals) {
    const uint item = get_global_id(0);
    if (!item_in_image(tiles, item)) return;
    float4 sum = start ? (float4)(0.0f) : estimates[item];
    float4 residual = start ? (float4)(0.0f) : residuals[item];
    add_values(rays, values, item, &sum, &residual);
    estimates[item] = sum;
    residuals[item] = residual;
}

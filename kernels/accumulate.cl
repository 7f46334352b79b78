// SPDX-License-Identifier: MIT
// Stage accumulate: adds one sample of each pixel to the image.
#include "lib/sum.h"
#include "lib/tiles.h"
#include "shared/material.h"
#include "shared/surface.h"

// image[y * width + x] += estimates[item], to whose rgb the surface's emission is added, cd/m2.
// residuals[y * width + x] belongs to the sum (lib/sum.h).
KERNEL void accumulate_add(Tiles tiles, __global const float4* estimates,
#if HAS_EMISSION
                           __global const Surface* surfaces, __global const Material* materials,
#endif
                           __global float4* image, __global float4* residuals) {
    const uint item = get_global_id(0);
    if (!item_in_image(tiles, item)) return;
    const uint2 position = item_pixel(tiles, item);
    const uint pixel = position.y * tiles.width + position.x;
    float4 term = estimates[item];
#if HAS_EMISSION
    __global const Surface* surface = surfaces + item;
    if (surface->position.w >= 0.0f) {
        const float4 emission = materials[surface->material].emission;
        if (surface->front || emission.w != 0.0f) term.xyz += emission.xyz;
    }
#endif
    float4 sum = image[pixel];
    float4 residual = residuals[pixel];
    add_compensated(&sum, &residual, term);
    image[pixel] = sum;
    residuals[pixel] = residual;
}

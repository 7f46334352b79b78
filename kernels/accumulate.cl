// SPDX-License-Identifier: MIT
// Stage accumulate: adds one sample of each pixel to the image.
#include "lib/cells.h"
#include "lib/sum.h"
#include "shared/groups.h"
#include "shared/material.h"
#include "shared/surface.h"

// image[y * width + x].rgb += weight x (estimates[item] + the surface's emission), cd/m2; .w +=
// shadow rays. HAS_EMITTER_PARTS: seen[item] is what stage emitter_parts has found. residuals[]
// belongs to the sum (lib/sum.h), weights[] is the sum of the weights. HAS_GROUPS: the sample
// belongs to one of ERROR_GROUPS groups: groups[ERROR_GROUPS * pixel + group] is the sum of weight
// x radiance, in w of weights.
#if HAS_EMISSION
#if HAS_EMITTER_PARTS
#define SEEN_PARAMETERS , __global const float4* seen
#define SEEN_ARGUMENTS , seen
#else
#define SEEN_PARAMETERS
#define SEEN_ARGUMENTS
#endif
#define EMISSION_PARAMETERS \
    , __global const Surface *surfaces, __global const Material *materials SEEN_PARAMETERS
#define EMISSION_ARGUMENTS , surfaces, materials SEEN_ARGUMENTS
#else
#define EMISSION_PARAMETERS
#define EMISSION_ARGUMENTS
#endif
#if HAS_GROUPS
#define GROUP_PARAMETERS , uint group, __global float4 *groups
#define GROUP_ARGUMENTS , group, groups
#else
#define GROUP_PARAMETERS
#define GROUP_ARGUMENTS
#endif
#define IMAGE_PARAMETERS                                                                        \
    __global const float4 *estimates EMISSION_PARAMETERS, float weight, __global float4 *image, \
        __global float4 *residuals, __global float *weights GROUP_PARAMETERS
#define IMAGE_ARGUMENTS \
    estimates EMISSION_ARGUMENTS, weight, image, residuals, weights GROUP_ARGUMENTS

static void add_sample(Tiles tiles, uint item, IMAGE_PARAMETERS) {
    if (!item_in_image(tiles, item)) return;
    const uint2 position = item_pixel(tiles, item);
    const uint pixel = position.y * tiles.width + position.x;
    float4 term = estimates[item];
#if HAS_EMISSION
    __global const Surface* surface = surfaces + item;
    if (surface->position.w >= 0.0f) {
        const float4 emission = materials[surface->shading].emission;
#if HAS_EMITTER_PARTS
        const float part = seen[item].w;
#else
        const float part = 1.0f;
#endif
        if (surface->front || emission.w != 0.0f) term.xyz += emission.xyz * part;
    }
#if HAS_EMITTER_PARTS
    term.xyz += seen[item].xyz;
#endif
#endif
    term.xyz *= weight;
    float4 sum = image[pixel];
    float4 residual = residuals[pixel];
    add_compensated(&sum, &residual, term);
    image[pixel] = sum;
    residuals[pixel] = residual;
    weights[pixel] += weight;
#if HAS_GROUPS
    groups[ERROR_GROUPS * pixel + group] += (float4)(term.xyz, weight);
#endif
}

// A sample of every pixel of the tiles.
KERNEL void accumulate_add(Tiles tiles, IMAGE_PARAMETERS) {
    if (get_global_id(0) < tiles.count * tiles.size * tiles.size)
        add_sample(tiles, get_global_id(0), IMAGE_ARGUMENTS);
}

// Of the pixels of a pass.
KERNEL void accumulate_add_pass(Tiles tiles, Pass pass, IMAGE_PARAMETERS) {
    if (get_global_id(0) < LANES * pass_groups(pass))
        add_sample(tiles, pass_item(pass, get_global_id(0)), IMAGE_ARGUMENTS);
}

// SPDX-License-Identifier: MIT
// Stage samples: the estimator of paper eq. (2), shared by the samplers that draw lights one by
// one.
//
// A sampler's file includes lib/draw.h, defines SAMPLER_PARAMETERS and SAMPLER_ARGUMENTS (the
// buffers it needs, each after a comma) and choose_light(), and then includes this file.
#include "lib/direct.h"
#include "lib/random.h"
#include "lib/sum.h"
#include "lib/tiles.h"

// Adds light samples first_sample to end_sample of sample_count to estimates[item].rgb, cd/m2, and
// their shadow rays to its w; the sample at 0 starts the sums, to which residuals[item] belongs
// (lib/sum.h). Neighbouring samples that are the same point share a shadow ray.
KERNEL void samples_draw(Tiles tiles, Camera camera, BVH_PARAMETERS,
                         __global const Surface* surfaces, __global const Material* materials,
                         __global const Light* lights, uint light_count SAMPLER_PARAMETERS,
                         uint pixel_sample, uint seed, uint first_sample, uint end_sample,
                         uint sample_count, __global float4* estimates,
                         __global float4* residuals) {
    const uint item = get_global_id(0);
    if (!item_in_image(tiles, item)) return;
    float4 sum = first_sample == 0u ? (float4)(0.0f) : estimates[item];
    float4 residual = first_sample == 0u ? (float4)(0.0f) : residuals[item];
    if (!surface_missed(surfaces + item)) {
        const Receiver receiver = make_receiver(surfaces + item, materials, camera);
        const uint2 pixel = item_pixel(tiles, item);
        uint last = ~0u;
        float3 value = (float3)(0.0f);
        for (uint sample = first_sample; sample < end_sample; ++sample) {
            const uint4 bits =
                random_bits(pixel.y * tiles.width + pixel.x, pixel_sample, sample, seed);
            const Choice choice =
                choose_light(item, sample, sample_count, bits.x, light_count SAMPLER_ARGUMENTS);
            if (choice.weight == 0.0f) continue;
            float rays = 0.0f;
            if (choice.light != last || !is_single_point(lights + choice.light)) {
                const float2 u = (float2)(unit_float(bits.y), unit_float(bits.z));
                Ray shadow;
                value = unshadowed(&receiver, lights + choice.light, u, &shadow) * choice.weight;
                if (any(value != 0.0f)) {
                    rays = 1.0f;
                    if (occluded(BVH_ARGUMENTS, shadow)) value = (float3)(0.0f);
                }
                last = choice.light;
            }
            add_compensated(&sum, &residual, (float4)(value, rays));
        }
    }
    estimates[item] = sum;
    residuals[item] = residual;
}

// SPDX-License-Identifier: MIT
// Sampler ward-unbiased: light samples of the lights that the walk left untested, which correct
// what kernel ward_tail added for them. For them their expected visibility is a control variate.
#include "lib/values.h"
#include "samplers/ward/walk.h"

// What a light of the tail is drawn in proportion to.
static float tail_weight(float4 contribution, float visible) {
    return contribution.w * sqrt(visible * (1.0f - visible) + TAIL_DOUBT);
}

// Draws first_draw to end_draw, at most 16, of draw_count from the tail, systematically in the
// order of the scene, without those lights that were tested. values[48 * slot + 16 * channel +
// lane]: what a light adds if it is visible; what it adds on average is taken away from the
// estimate. Draws of one light share a ray.
KERNEL void ward_draw_tail(Tiles tiles, VIEW_PARAMETERS, __global const Surface* surfaces,
                           __global const Material* materials, __global const Light* lights,
                           uint light_count, uint pixel_sample, uint seed, uint first_item,
                           uint slots, uint first_draw, uint end_draw, uint draw_count,
                           __global const uint* histories, __global const float4* contributions,
                           __global const float4* walks, __global const uint4* counts,
                           __global float4* origins, __global float* rays, __global float* values,
                           __global float4* estimates, __global float4* residuals) {
    const uint slot = get_global_id(0);
    if (slot >= slots) return;
    const uint item = first_item + slot;
    uint lane = 0u;
    if (counts[slot].y < counts[slot].x) {
        __global const float4* own = contributions + slot_lights(slot, light_count);
        __global const uint* own_histories = item_histories(tiles, item, histories, light_count);
        const Receiver receiver = make_receiver(surfaces, item, materials, VIEW);
        const uint2 pixel = item_pixel(tiles, item);
        const uint number = pixel.y * tiles.width + pixel.x;
        const float4 walk = walks[slot];
        float4 sum = estimates[item], residual = residuals[item];
        float total = 0.0f, total_residual = 0.0f;
        for (uint light = 0u; light < light_count; ++light)
            if (own[light].w > 0.0f)
                add_compensated_1(
                    &total, &total_residual,
                    tail_weight(own[light], expected_visibility(walk, own_histories[light])));
        const float step = total / (float)draw_count;
        const float shift = unit_float(random_bits(number, pixel_sample, RANDOM_TAIL, seed).x);
        float passed = 0.0f, passed_residual = 0.0f;
        uint draw = first_draw;
        for (uint light = 0u; light < light_count && draw < end_draw; ++light) {
            const float4 contribution = own[light];
            if (!(contribution.w > 0.0f)) continue;
            const float visible = expected_visibility(walk, own_histories[light]);
            const float weight = tail_weight(contribution, visible);
            add_compensated_1(&passed, &passed_residual, weight);
            uint times = 0u;
            for (; draw < end_draw && ((float)draw + shift) * step < passed; ++draw) ++times;
            if (times == 0u) continue;
            const float3 value = contribution.xyz * ((float)times * step / weight);
            add_compensated(&sum, &residual, (float4)(-visible * value, 0.0f));
            const float2 u = point_of_light(lights + light, light, number, pixel_sample, seed);
            Ray shadow;
            if (!any(unshadowed(&receiver, lights + light, u, &shadow) != 0.0f)) continue;
            put_ray(rays, slot, lane, shadow);
            __global float* lanes = values + 48 * (ulong)slot + lane;
            lanes[0] = value.x;
            lanes[16] = value.y;
            lanes[32] = value.z;
            ++lane;
        }
        origins[slot] = (float4)(shadow_origin(&receiver), 0.0f);
        estimates[item] = sum;
        residuals[item] = residual;
    }
    for (; lane < 16u; ++lane) RAY_END(rays, slot, lane) = 0.0f;
}

// Adds the draws whose rays passed.
KERNEL void ward_add_tail(uint first_item, uint slots, __global const float* rays,
                          __global const float* values, __global float4* estimates,
                          __global float4* residuals) {
    const uint slot = get_global_id(0);
    if (slot >= slots) return;
    const uint item = first_item + slot;
    float4 sum = estimates[item], residual = residuals[item];
    add_values(rays, values, slot, &sum, &residual);
    estimates[item] = sum;
    residuals[item] = residual;
}

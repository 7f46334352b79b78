// SPDX-License-Identifier: MIT
// Sampler ward: lights in descending order of their unshadowed contributions are tested until what
// is left cannot matter much; that is added as far as it is expected to be visible (Ward, "Adaptive
// Shadow Testing for Ray Tracing", 1991). Stage shadows traces the rays.
#include "samplers/ward/walk.h"

// Lets order[at] sink to its place in a heap of `size` entries.
static void sink(__global ulong* order, uint size, uint at) {
    const ulong entry = order[at];
    while (2u * at + 1u < size) {
        uint child = 2u * at + 1u;
        if (child + 1u < size && order[child + 1u] > order[child]) ++child;
        if (order[child] < entry) break;
        order[at] = order[child];
        at = child;
    }
    order[at] = entry;
}

// Puts the first entry of a heap of `size` behind it. Returns its contribution's luminance.
static float pop(__global ulong* order, uint size) {
    const ulong entry = order[0];
    order[0] = order[size - 1u];
    if (size > 1u) sink(order, size - 1u, 0u);
    order[size - 1u] = entry;
    return entry_size(entry);
}

// Adds to a walk's sum.
static void add_to_rest(float4* walk, float term) {
    float sum = walk->x, residual = walk->y;
    add_compensated_1(&sum, &residual, term);
    walk->xy = (float2)(sum, residual);
}

// Evaluates all lights at a pixel sample, and puts them in a heap. The rule's sum starts as that of
// the first look_ahead lights in descending order.
KERNEL void ward_weigh(Tiles tiles, VIEW_PARAMETERS, __global const Surface* surfaces,
                       __global const Material* materials, __global const Light* lights,
                       uint light_count, uint pixel_sample, uint seed, uint look_ahead,
                       uint first_item, uint slots, __global float4* contributions,
                       __global uint2* order, __global float4* walks, __global uint4* counts,
                       __global float4* estimates, __global float4* residuals) {
    const uint slot = get_global_id(0);
    if (slot >= slots) return;
    const uint item = first_item + slot;
    float4 walk = (float4)(0.0f);
    uint lit = 0u, sorted = 0u;
    if (item_in_image(tiles, item) && !surface_missed(surfaces + item)) {
        const Receiver receiver = make_receiver(surfaces, item, materials, VIEW);
        const uint2 pixel = item_pixel(tiles, item);
        const uint number = pixel.y * tiles.width + pixel.x;
        __global float4* own = contributions + slot_lights(slot, light_count);
        __global ulong* own_order = slot_order(order, slot, light_count);
        for (uint light = 0u; light < light_count; ++light) {
            const float2 u = point_of_light(lights + light, light, number, pixel_sample, seed);
            Ray shadow;
            const float3 value = unshadowed(&receiver, lights + light, u, &shadow);
            const float size = luminance(value);
            own[light] = (float4)(value, size);
            if (!(size > 0.0f)) continue;
            own_order[lit++] = entry_of(size, light);
            add_to_rest(&walk, size);
        }
        for (uint at = lit / 2u; at > 0u; --at) sink(own_order, lit, at - 1u);
        if (look_ahead < lit) {
            walk.xy = (float2)(0.0f);
            for (; sorted < look_ahead; ++sorted) add_to_rest(&walk, pop(own_order, lit - sorted));
        }
    }
    walks[slot] = walk;
    counts[slot] = (uint4)(lit, 0u, sorted, 0u);
    estimates[item] = (float4)(0.0f);
    residuals[item] = (float4)(0.0f);
}

// The end of a ray of a slot's packets.
#define STEP_END(rays, slot, ray) \
    RAY_END(rays, (ulong)(slot)*STEP_PACKETS + (ray) / 16u, (ray) % 16u)

// Adds the lights of a step whose rays were traced, and marks them as tested.
static void add_step(__global const float* rays, uint slot, uint4 count,
                     __global const ulong* order, __global const uint* histories,
                     __global float4* contributions, float4* walk, float4* sum, float4* residual) {
    for (uint ray = 0u; ray < count.w; ++ray) {
        const uint light = entry_light(order[count.x - 1u - (count.y - count.w + ray)]);
        const bool visible = STEP_END(rays, slot, ray) > 0.0f;
        walk->z += history_share(histories[light]);
        walk->w += visible ? 1.0f : 0.0f;
        const float3 value = visible ? contributions[light].xyz : (float3)(0.0f);
        add_compensated(sum, residual, (float4)(value, 1.0f));
        contributions[light].w = 0.0f;
    }
}

// Adds what the rays of the last step found, then makes those of the next: to the lights that
// follow, as many as would be tested if all of them were visible, up to STEP_PACKETS packets. So no
// ray is traced in vain.
KERNEL void ward_step(Tiles tiles, VIEW_PARAMETERS, __global const Surface* surfaces,
                      __global const Material* materials, __global const Light* lights,
                      uint light_count, uint pixel_sample, uint seed, float tau, uint look_ahead,
                      uint first_item, uint slots, __global const uint* histories,
                      __global float4* contributions, __global uint2* order, __global float4* walks,
                      __global uint4* counts, __global float4* origins, __global float* rays,
                      __global float4* estimates, __global float4* residuals) {
    const uint slot = get_global_id(0);
    if (slot >= slots) return;
    const uint item = first_item + slot;
    uint4 count = counts[slot];
    const ulong first = (ulong)slot * STEP_PACKETS;
    uint ray = 0u;
    const bool stopped = count.y > 0u && count.w == 0u;
    if (count.x > 0u && !stopped) {
        __global float4* own = contributions + slot_lights(slot, light_count);
        __global ulong* own_order = slot_order(order, slot, light_count);
        float4 walk = walks[slot];
        float4 sum = estimates[item], residual = residuals[item];
        add_step(rays, slot, count, own_order, item_histories(tiles, item, histories, light_count),
                 own, &walk, &sum, &residual);
        float known = luminance(sum.xyz);  // if all that follow are visible
        const Receiver receiver = make_receiver(surfaces, item, materials, VIEW);
        const uint2 pixel = item_pixel(tiles, item);
        const uint number = pixel.y * tiles.width + pixel.x;
        for (; ray < 16u * STEP_PACKETS && count.y < count.x && !(max(walk.x, 0.0f) < tau * known);
             ++ray) {
            if (count.z == count.y) pop(own_order, count.x - count.z++);
            const ulong entry = own_order[count.x - 1u - count.y++];
            const uint light = entry_light(entry);
            const float size = entry_size(entry);
            known += size;
            add_to_rest(&walk, -size);
            if (look_ahead < count.x && count.z < count.x)
                add_to_rest(&walk, pop(own_order, count.x - count.z++));
            const float2 u = point_of_light(lights + light, light, number, pixel_sample, seed);
            Ray shadow;
            if (any(unshadowed(&receiver, lights + light, u, &shadow) != 0.0f))
                put_ray(rays, first + ray / 16u, ray % 16u, shadow);
            else
                STEP_END(rays, slot, ray) = 0.0f;
        }
        count.w = ray;
        for (uint i = 0u; i < STEP_PACKETS; ++i)
            origins[first + i] = (float4)(shadow_origin(&receiver), 0.0f);
        walks[slot] = walk;
        counts[slot] = count;
        estimates[item] = sum;
        residuals[item] = residual;
    }
    for (; ray < 16u * STEP_PACKETS; ++ray) STEP_END(rays, slot, ray) = 0.0f;
}

// Adds the lights that were not tested, each by its expected visibility.
KERNEL void ward_tail(Tiles tiles, uint light_count, uint first_item, uint slots,
                      __global const uint* histories, __global const float4* contributions,
                      __global const float4* walks, __global const uint4* counts,
                      __global float4* estimates, __global float4* residuals) {
    const uint slot = get_global_id(0);
    if (slot >= slots) return;
    if (counts[slot].y == counts[slot].x) return;
    const uint item = first_item + slot;
    __global const float4* own = contributions + slot_lights(slot, light_count);
    __global const uint* own_histories = item_histories(tiles, item, histories, light_count);
    const float4 walk = walks[slot];
    float4 sum = estimates[item], residual = residuals[item];
    for (uint light = 0u; light < light_count; ++light) {
        const float4 contribution = own[light];
        if (!(contribution.w > 0.0f)) continue;
        const float visible = expected_visibility(walk, own_histories[light]);
        add_compensated(&sum, &residual, (float4)(visible * contribution.xyz, 0.0f));
    }
    estimates[item] = sum;
    residuals[item] = residual;
}

// SPDX-License-Identifier: MIT
// Stage samples: draws the light samples of paper eq. (2), shared by the samplers that draw lights
// one by one. Stage shadows traces their rays, samples.cl adds them up.
//
// A sampler's file includes lib/draw.h, defines SAMPLER_PARAMETERS and SAMPLER_ARGUMENTS (the
// buffers it needs, each after a comma) and choose_light(), and then includes this file.
//
// One that makes something of a pixel once for all light samples of a launch defines PIXEL_STATE,
// its type, too, and begin_pixel(), which fills it: its arguments are choose_light()'s for the
// first of them, but for the random bits, and a pointer to the state, which choose_light() then
// gets, too.
//
// One whose light samples have a probability in closed form defines CLOSED_FORM, and
// light_probability() as lib/reflected.h has it, which it includes in the end.
#include "lib/direct.h"
#include "lib/random.h"
#include "lib/rays.h"
#include "lib/tiles.h"

#ifdef PIXEL_STATE
#define STATE_ARGUMENT , &state
#else
#define STATE_ARGUMENT
#endif

// 1 / the number of light samples that stage reflections expects on the light of a choice.
#ifdef CLOSED_FORM
#define SHARE_WEIGHT(choice) (choice).weight
#else
#define SHARE_WEIGHT(choice) 1.0f
#endif

// Light samples first_sample to end_sample, at most 16, of sample_count: packet `item` of the rays,
// and values[48 * item + 16 * channel + lane], what each contributes where nothing is in its way,
// cd/m2. Neighbouring samples that are the same point share a ray, samples without a value have
// none.
KERNEL void samples_draw(Tiles tiles, VIEW_PARAMETERS, __global const Surface* surfaces,
                         __global const Material* materials, __global const Light* lights,
                         uint light_count SAMPLER_PARAMETERS, uint pixel_sample, uint seed,
                         uint first_sample, uint end_sample, uint sample_count,
                         __global float4* origins, __global float* rays, __global float* values) {
    const uint item = get_global_id(0);
    if (item >= tiles.count * tiles.size * tiles.size) return;
    uint lane = 0u;
    if (item_in_image(tiles, item) && !surface_missed(surfaces + item)) {
        const Receiver receiver = make_receiver(surfaces, item, materials, VIEW);
        const uint2 pixel = item_pixel(tiles, item);
#ifdef PIXEL_STATE
        PIXEL_STATE state;
        const Draw first = {item, first_sample, sample_count, (uint4)(0u), light_count};
        begin_pixel(&receiver, lights, first SAMPLER_ARGUMENTS STATE_ARGUMENT);
#endif
        __global float* value_lanes = values + 48 * (ulong)item;
        uint last = ~0u;
        bool lit = false;
        float3 last_value = (float3)(0.0f);
        for (uint sample = first_sample; sample < end_sample; ++sample) {
            const uint4 bits =
                random_bits(pixel.y * tiles.width + pixel.x, pixel_sample, sample, seed);
            const Draw draw = {item, sample, sample_count, bits, light_count};
            const Choice choice =
                choose_light(&receiver, lights, draw SAMPLER_ARGUMENTS STATE_ARGUMENT);
            if (choice.weight == 0.0f) continue;
            if (choice.light == last && is_single_point(lights + choice.light)) {
                if (!lit) continue;
                value_lanes[lane - 1u] += last_value.x * choice.weight;
                value_lanes[lane + 15u] += last_value.y * choice.weight;
                value_lanes[lane + 31u] += last_value.z * choice.weight;
                continue;
            }
            const float2 u = (float2)(unit_float(bits.y), unit_float(bits.z));
            Ray shadow;
            last_value = unshadowed_weighed(&receiver, lights + choice.light, u,
                                            SHARE_WEIGHT(choice), &shadow);
            last = choice.light;
            lit = any(last_value != 0.0f);
            if (!lit) continue;
            put_ray(rays, item, lane, shadow);
            value_lanes[lane] = last_value.x * choice.weight;
            value_lanes[lane + 16u] = last_value.y * choice.weight;
            value_lanes[lane + 32u] = last_value.z * choice.weight;
            if (lane == 0u) origins[item] = (float4)(shadow.origin, 0.0f);
            ++lane;
        }
    }
    for (; lane < 16u; ++lane) RAY_END(rays, item, lane) = 0.0f;
}

// SPDX-License-Identifier: MIT
// Sampler ris: 32 candidates by the lights' power, of which one is drawn by its contribution
// without visibility (resampled importance sampling: Talbot, Cline, Egbert, "Importance Resampling
// for Global Illumination", 2005). Candidates are stratified over all samples of the pixel.
#include "lib/direct.h"
#include "lib/draw.h"
#include "lib/random.h"
#include "shared/ris.h"

#define SAMPLER_PARAMETERS , __global const uint* power_cdf
#define SAMPLER_ARGUMENTS , power_cdf

static Choice choose_light(const Receiver* receiver, __global const Light* lights, Draw draw,
                           __global const uint* power_cdf) {
    Choice choice = {0u, 0.0f};
    const uint total = power_cdf[draw.light_count - 1u];
    if (total == 0u) return choice;
    const float2 u = (float2)(unit_float(draw.bits.y), unit_float(draw.bits.z));
    float sum = 0.0f;  // of contribution / width
    float chosen = 0.0f;
    for (uint i = 0u; i < CANDIDATES; ++i) {
        const uint target =
            stratified_below(total, i * draw.sample_count + draw.sample,
                             CANDIDATES * draw.sample_count, step_bits(draw.bits.x, i));
        const uint light = search_cdf(power_cdf, draw.light_count, target);
        Ray shadow;
        const float contribution = luminance(unshadowed(receiver, lights + light, u, &shadow));
        const float weight = contribution / (float)cdf_width(power_cdf, light);
        sum += weight;
        if (weight > 0.0f && unit_float(step_bits(draw.bits.w, i)) * sum < weight) {
            choice.light = light;
            chosen = contribution;
        }
    }
    if (chosen > 0.0f)
        choice.weight =
            sum * (float)total / (chosen * (float)CANDIDATES * (float)draw.sample_count);
    return choice;
}

#include "lib/samples.h"

// SPDX-License-Identifier: MIT
// Sampler lighttree: down a light tree by the importance of its nodes, as pbrt-v4's BVH light
// sampler; the light samples of a pixel are stratified.
#include "lib/draw.h"
#include "lib/light_tree.h"
#include "lib/random.h"

#define SAMPLER_PARAMETERS , __global const LightNode *nodes, uint root_count, uint second_root
#define SAMPLER_ARGUMENTS , nodes, root_count, second_root
#define CLOSED_FORM

static Choice choose_light(const Receiver* receiver, __global const Light* lights, Draw draw,
                           __global const LightNode* nodes, uint root_count, uint second_root) {
    const Choice none = {0u, 0.0f};
    const float count = (float)draw.sample_count;
    float u = ((float)draw.sample + unit_float(draw.bits.x)) / count;
    float probability = 1.0f;
    uint node = 0u;
    // Step 0 chooses between the roots, if there are two.
    for (uint step = root_count > 1u ? 0u : 1u; step == 0u || nodes[node].count > 1u; ++step) {
        const uint left = step == 0u ? 0u : node + 1u;
        const uint right = step == 0u ? second_root : node + 2u * nodes[node + 1u].count;
        const float a = node_importance(nodes + left, receiver);
        const float b = node_importance(nodes + right, receiver);
        if (!(a + b > 0.0f)) return none;
        // Where less than one sample is expected strata have no use any more: fresh digits.
        if (probability * count < 1.0f) u = unit_float(step_bits(draw.bits.w, step));
        const float p = a / (a + b);
        const bool go_left = u < p;
        const float taken = go_left ? p : b / (a + b);
        u = min((go_left ? u : u - p) / taken, 0x1.fffffep-1f);
        probability *= taken;
        node = go_left ? left : right;
    }
    const Choice choice = {nodes[node].first, 1.0f / (probability * count)};
    return choice;
}

// The product of the choices on the way down to the light's leaf.
static float light_probability(const Receiver* receiver, __global const Light* lights, Draw draw,
                               uint light, __global const LightNode* nodes, uint root_count,
                               uint second_root) {
    float probability = 1.0f;
    uint node = 0u;
    for (uint step = root_count > 1u ? 0u : 1u; step == 0u || nodes[node].count > 1u; ++step) {
        const uint left = step == 0u ? 0u : node + 1u;
        const uint right = step == 0u ? second_root : node + 2u * nodes[node + 1u].count;
        const float a = node_importance(nodes + left, receiver);
        const float b = node_importance(nodes + right, receiver);
        if (!(a + b > 0.0f)) return 0.0f;
        const bool go_left = light < nodes[right].first;
        probability *= (go_left ? a : b) / (a + b);
        node = go_left ? left : right;
    }
    return probability;
}

#include "lib/samples.h"

#include "lib/reflected.h"

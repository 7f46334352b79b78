// SPDX-License-Identifier: MIT
// Sampler adaptive: a light of each drawn node, its shadow ray, and what comes of it.
#include "lib/cells.h"
#include "lib/direct.h"
#include "lib/random.h"
#include "lib/rays.h"
#include "shared/light_tree.h"

#include "lib/node_estimate.h"
#define WIDE_POINTS 1
#include "lib/node_estimate.h"
#define WIDE_POINTS 1
#define WIDE_NODES 1
#include "lib/direct_n.h"
#include "lib/node_estimate.h"

// Lights of the lanes' nodes, drawn child by child by their estimates.
typedef struct Descent_n {
    uint_n lights;
    float_n probability;  // 0: none can contribute
} Descent_n;

INLINE Descent_n descend_n(__global const LightNode* nodes, __global const Light* lights,
                           const Points_n* points, int_n used, uint_n start, float_n u, uint_n bits,
                           Node_n* drawn) {
    Descent_n d;
    uint_n count;
    d.probability = (float_n)(1.0f);
    uint_n at = start;
    *drawn = load_nodes_n(nodes, lights, at, &d.lights, &count);
    int_n going = used & as_int_n(count > 1u);
    for (uint step = 0u; lanes_n(going); ++step) {
        if (step > 0u) u = unit_float_n(step_bits_n(bits, step));
        uint_n left_light, left_count, right_light, right_count;
        const uint_n left_at = select(at, at + 1u, as_uint_n(going));
        const Node_n left = load_nodes_n(nodes, lights, left_at, &left_light, &left_count);
        const uint_n right_at = select(at, at + 2u * left_count, as_uint_n(going));
        const Node_n right = load_nodes_n(nodes, lights, right_at, &right_light, &right_count);
        const float_n a = color_luminance_n(node_estimate_n_n(&left, points));
        const float_n b = color_luminance_n(node_estimate_n_n(&right, points));
        const float_n p = a / (a + b);
        const int_n go_left = u < p;
        const int_n possible = a + b > 0.0f;
        const float_n chosen = select((float_n)(0.0f), select(b / (a + b), p, go_left), possible);
        d.probability *= select((float_n)(1.0f), chosen, going);
        const uint_n steps_left = as_uint_n(going & go_left);
        const uint_n steps_right = as_uint_n(going & !go_left);
        at = select(select(at, left_at, steps_left), right_at, steps_right);
        count = select(select(count, left_count, steps_left), right_count, steps_right);
        d.lights = select(select(d.lights, left_light, steps_left), right_light, steps_right);
        going = going & possible & as_int_n(count > 1u);
    }
    return d;
}

// Draws a light for each drawn node of a group, and its ray: a pixel's draw i is lane i % 16 of its
// packet i / 16; values as in lib/samples.h. Takes the control variate of what is drawn away from
// base[]. One group per work-item.
KERNEL void adaptive_aim(Tiles tiles, VIEW_PARAMETERS, Pass pass, __global const Surface* surfaces,
                         __global const Material* materials, __global const Light* lights,
                         __global const LightNode* nodes, uint pixel_sample, uint seed,
                         __global const uint* draws, __global const uint* draw_counts,
                         __global const uint* pixel_packets, __global float_n* base,
                         __global float4* origins, __global float* rays, __global float* values) {
    const uint group = get_global_id(0);
    if (group >= pass_groups(pass)) return;
    const uint size = draw_counts[group];
    if (size == 0u) return;
    const Receivers_n receivers = load_receivers_n(tiles, pass, group, VIEW, surfaces, materials);
    __global const uint* own_packets = pixel_packets + 2u * LANES * group;
    for (uint lane = 0u; lane < LANES; ++lane)
        for (uint i = 0u; i < own_packets[LANES + lane]; ++i) {
            clear_packet(rays, own_packets[lane] + i);
            origins[own_packets[lane] + i] =
                (float4)(LANE(receivers.from.x, lane), LANE(receivers.from.y, lane),
                         LANE(receivers.from.z, lane), 0.0f);
        }
    const float_n pixels = as_float_n(receivers.y * tiles.width + receivers.x);
    const float_n first_packets = FLOATS_AT(own_packets);
    float_n drawn_red = (float_n)(0.0f), drawn_green = drawn_red, drawn_blue = drawn_red;
    for (uint begin = 0u; begin < size; begin += LANES) {
        const int_n used = lane_numbers() < (int)(size - begin);
        __global const uint* rows = draws + DRAW_ROW(pass, group, begin, 0u) + begin % 16u;
        const uint_n none = (uint_n)(0u);
        const uint_n node =
            select(none, DRAWN_NODE(UINTS_AT(rows + 16u * DRAW_ENTRY)), as_uint_n(used));
        const uint_n bits = UINTS_AT(rows + 16u * DRAW_LANE);
        const float_n share = FLOATS_AT(rows + 16u * DRAW_SHARE);
        const float_n control = FLOATS_AT(rows + 16u * DRAW_CONTROL);
        const uint_n cell = bits & 15u, number = bits >> 4u & 0x1ffu;
        const float_n stratum = convert_float_n(bits >> 13u & 0x1ffu);
        const Points_n points = permute_points(&receivers.points, cell);
        const Origins_n from = permute_origins(&receivers.from, cell);
        uint_n random[4];
        random_bits_n(as_uint_n(permute_n(pixels, cell)), pixel_sample,
                      RANDOM_DRAWS * pass.number + number, seed, random);
        const float_n u = (stratum + unit_float_n(random[0])) / convert_float_n(bits >> 22u);
        Node_n drawn;
        const Descent_n d = descend_n(nodes, lights, &points, used, node, u, random[3], &drawn);
        const Color_n estimate = node_estimate_n_n(&drawn, &points);
        const int_n possible = used & (d.probability > 0.0f);
        const Lights_n drawn_lights = load_lights_n(lights, d.lights, possible);
        const Direct_n direct = direct_n(&drawn_lights, &points, &from, unit_float_n(random[1]),
                                         unit_float_n(random[2]));
        const float_n red = direct.value.red, green = direct.value.green, blue = direct.value.blue;
        const float_n inverse = 1.0f / (share * d.probability);
        const uint_n place =
            16u * (as_uint_n(permute_n(first_packets, cell)) + number / 16u) + number % 16u;
        const uint lit = lanes_n(possible & (red + green + blue > 0.0f));
        for (uint lane = 0u; lane < min(size - begin, (uint)LANES); ++lane) {
            const uint own = UINT_LANE(cell, lane);
            const float lost = LANE(control, lane);
            SET_LANE(drawn_red, own, LANE(drawn_red, own) + lost * LANE(estimate.red, lane));
            SET_LANE(drawn_green, own, LANE(drawn_green, own) + lost * LANE(estimate.green, lane));
            SET_LANE(drawn_blue, own, LANE(drawn_blue, own) + lost * LANE(estimate.blue, lane));
            const uint at = UINT_LANE(place, lane);
            __global float* row = rays + 64 * (ulong)(at / 16u) + at % 16u;
            if (!(lit >> lane & 1u)) {
                row[48] = DARK;
                continue;
            }
            row[0] = LANE(direct.x, lane);
            row[16] = LANE(direct.y, lane);
            row[32] = LANE(direct.z, lane);
            row[48] = LANE(direct.end, lane);
            __global float* value = values + 48 * (ulong)(at / 16u) + at % 16u;
            const float scale = LANE(inverse, lane);
            value[0] = LANE(red, lane) * scale;
            value[16] = LANE(green, lane) * scale;
            value[32] = LANE(blue, lane) * scale;
        }
    }
    base[3u * group] -= drawn_red;
    base[3u * group + 1u] -= drawn_green;
    base[3u * group + 2u] -= drawn_blue;
}

// estimates[item], cd/m2, and in w the number of rays, of the pass's pixels: base plus what is
// visible. `weight` of this draw is added to what is there, unless `start` says that it is the
// first.
KERNEL void adaptive_add(Pass pass, __global const uint* pixel_packets, __global const float* base,
                         __global const float* rays, __global const float* values, float weight,
                         uint start, __global float4* estimates) {
    const uint p = get_global_id(0);
    const uint group = p / LANES, lane = p % LANES;
    if (group >= pass_groups(pass)) return;
    const uint first = pixel_packets[2u * LANES * group + lane];
    const uint end = first + pixel_packets[2u * LANES * group + LANES + lane];
    float_n red = (float_n)(0.0f), green = red, blue = red;
    uint count = 0u;
    for (uint packet = first; packet < end; ++packet)
        for (uint i = 0u; i < 16u; i += LANES) {
            const float_n ends = FLOATS_AT(rays + 64 * (ulong)packet + 48u + i);
            __global const float* own = values + 48 * (ulong)packet + i;
            const int_n visible = ends > 0.0f;
            count += popcount(lanes_n((ends != 0.0f) & (ends != DARK)));
            red += select((float_n)(0.0f), FLOATS_AT(own), visible);
            green += select((float_n)(0.0f), FLOATS_AT(own + 16), visible);
            blue += select((float_n)(0.0f), FLOATS_AT(own + 32), visible);
        }
    __global const float* own_base = base + 3u * LANES * group + lane;
    const float3 sum = (float3)(own_base[0] + sum_of(red), own_base[LANES] + sum_of(green),
                                own_base[2u * LANES] + sum_of(blue));
    const uint item = pass_item(pass, p);
    const float4 term = (float4)(weight * sum, (float)count);
    estimates[item] = start ? term : estimates[item] + term;
}

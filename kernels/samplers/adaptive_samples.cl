// SPDX-License-Identifier: MIT
// Sampler adaptive: a light of each drawn node, its shadow ray, and what comes of it.
#include "lib/cells.h"
#include "lib/direct.h"
#include "lib/inverse.h"
#include "lib/random.h"
#include "lib/rays.h"
#include "lib/transpose_16.h"
#include "shared/light_tree.h"

#define LANES 1
#define NODES 1
#include "lib/node_estimate.h"
#undef LANES
#define LANES 16
#include "lib/node_estimate.h"
#undef NODES
#define NODES 16
#include "lib/node_estimate.h"
#undef NODES
#undef LANES
#include "lib/direct_16.h"

// Lights of the lanes' nodes, drawn child by child by their estimates.
typedef struct Descent_16 {
    uint16 lights;
    float16 probability;  // 0: none can contribute
} Descent_16;

static Descent_16 descend_16(__global const LightNode* nodes, __global const Light* lights,
                             const Points_16* points, int16 used, uint16 start, float16 u,
                             uint16 bits, Node_16* drawn) {
    Descent_16 d;
    uint16 count;
    d.probability = (float16)(1.0f);
    uint16 at = start;
    *drawn = load_nodes_16(nodes, lights, at, &d.lights, &count);
    int16 going = used & as_int16(count > 1u);
    for (uint step = 0u; lanes_16(going); ++step) {
        if (step > 0u) u = unit_float_16(step_bits_16(bits, step));
        uint16 left_light, left_count, right_light, right_count;
        const uint16 left_at = select(at, at + 1u, as_uint16(going));
        const Node_16 left = load_nodes_16(nodes, lights, left_at, &left_light, &left_count);
        const uint16 right_at = select(at, at + 2u * left_count, as_uint16(going));
        const Node_16 right = load_nodes_16(nodes, lights, right_at, &right_light, &right_count);
        const float16 a = color_luminance_16(node_estimate_16_16(&left, points));
        const float16 b = color_luminance_16(node_estimate_16_16(&right, points));
        const float16 p = a / (a + b);
        const int16 go_left = u < p;
        const int16 possible = a + b > 0.0f;
        const float16 chosen = select((float16)(0.0f), select(b / (a + b), p, go_left), possible);
        d.probability *= select((float16)(1.0f), chosen, going);
        const uint16 steps_left = as_uint16(going & go_left);
        const uint16 steps_right = as_uint16(going & ~go_left);
        at = select(select(at, left_at, steps_left), right_at, steps_right);
        count = select(select(count, left_count, steps_left), right_count, steps_right);
        d.lights = select(select(d.lights, left_light, steps_left), right_light, steps_right);
        going = going & possible & as_int16(count > 1u);
    }
    return d;
}

// Draws a light for each drawn node of a group, and its ray: a pixel's draw i is lane i % 16 of its
// packet i / 16; values as in lib/samples.h. Takes the control variate of what is drawn away from
// base[]. One group per work-item.
KERNEL void adaptive_aim(Tiles tiles, Camera camera, Pass pass, __global const Surface* surfaces,
                         __global const Material* materials, __global const Light* lights,
                         __global const LightNode* nodes, uint pixel_sample, uint seed,
                         __global const uint* draws, __global const uint* draw_counts,
                         __global const uint* pixel_packets, __global float16* base,
                         __global float4* origins, __global float* rays, __global float* values) {
    const uint group = get_global_id(0);
    if (group >= pass_groups(pass)) return;
    const uint size = draw_counts[group];
    if (size == 0u) return;
    const Receivers_16 receivers =
        load_receivers_16(tiles, pass, group, camera, surfaces, materials);
    __global const uint* own_packets = pixel_packets + 32u * group;
    for (uint cell = 0u; cell < 16u; ++cell)
        for (uint i = 0u; i < own_packets[16u + cell]; ++i) {
            clear_packet(rays, own_packets[cell] + i);
            origins[own_packets[cell] + i] =
                (float4)(LANE(receivers.from.x, cell), LANE(receivers.from.y, cell),
                         LANE(receivers.from.z, cell), 0.0f);
        }
    const float16 pixels = as_float16(receivers.y * tiles.width + receivers.x);
    const float16 first_packets = as_float16(vload16(0, own_packets));
    float16 drawn_red = (float16)(0.0f), drawn_green = drawn_red, drawn_blue = drawn_red;
    for (uint begin = 0u; begin < size; begin += 16u) {
        const int16 used = numbers_16() < (int)(size - begin);
        __global const uint* rows = draws + DRAW_ROW(pass, group, begin, 0u);
        const uint16 none = (uint16)(0u);
        const uint16 node = select(none, DRAWN_NODE(vload16(DRAW_ENTRY, rows)), as_uint16(used));
        const uint16 bits = vload16(DRAW_CELL, rows);
        const float16 share = as_float16(vload16(DRAW_SHARE, rows));
        const float16 control = as_float16(vload16(DRAW_CONTROL, rows));
        const uint16 cell = bits & 15u, number = bits >> 4u & 0x1ffu;
        const float16 stratum = convert_float16(bits >> 13u & 0x1ffu);
        const Points_16 points = permute_points(&receivers.points, cell);
        const Origins_16 from = permute_origins(&receivers.from, cell);
        uint16 random[4];
        random_bits_16(as_uint16(permute_16(pixels, cell)), pixel_sample,
                       RANDOM_DRAWS * pass.number + number, seed, random);
        const float16 u = (stratum + unit_float_16(random[0])) / convert_float16(bits >> 22u);
        Node_16 drawn;
        const Descent_16 d = descend_16(nodes, lights, &points, used, node, u, random[3], &drawn);
        const Color_16 estimate = node_estimate_16_16(&drawn, &points);
        const int16 possible = used & (d.probability > 0.0f);
        const Lights_16 drawn_lights = load_lights_16(lights, d.lights, possible);
        const Direct_16 direct = direct_16(&drawn_lights, &points, &from, unit_float_16(random[1]),
                                           unit_float_16(random[2]));
        const float16 red = direct.value.red, green = direct.value.green, blue = direct.value.blue;
        const float16 inverse = 1.0f / (share * d.probability);
        const uint16 place =
            16u * (as_uint16(permute_16(first_packets, cell)) + number / 16u) + number % 16u;
        const uint lit = lanes_16(possible & (red + green + blue > 0.0f));
        for (uint lane = 0u; lane < min(size - begin, 16u); ++lane) {
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

static float sum_where(__global const float* values, int16 condition) {
    const float16 v = select((float16)(0.0f), vload16(0, values), condition);
    const float8 a = v.lo + v.hi;
    const float4 b = a.lo + a.hi;
    return b.x + b.y + (b.z + b.w);
}

// estimates[item], cd/m2, and in w the number of rays, of the pass's pixels: base plus what is
// visible. `weight` of this draw is added to what is there, unless `start` says that it is the
// first.
KERNEL void adaptive_add(Pass pass, __global const uint* pixel_packets, __global const float* base,
                         __global const float* rays, __global const float* values, float weight,
                         uint start, __global float4* estimates) {
    const uint p = get_global_id(0);
    const uint group = p / 16u, cell = p % 16u;
    if (group >= pass_groups(pass)) return;
    const uint first = pixel_packets[32u * group + cell];
    const uint end = first + pixel_packets[32u * group + 16u + cell];
    __global const float* own_base = base + 48u * group + cell;
    float3 sum = (float3)(own_base[0], own_base[16], own_base[32]);
    uint count = 0u;
    for (uint packet = first; packet < end; ++packet) {
        const float16 ends = vload16(3, rays + 64 * (ulong)packet);
        __global const float* own = values + 48 * (ulong)packet;
        const int16 visible = ends > 0.0f;
        count += popcount(lanes_16((ends != 0.0f) & (ends != DARK)));
        sum += (float3)(sum_where(own, visible), sum_where(own + 16, visible),
                        sum_where(own + 32, visible));
    }
    const uint item = pass_item(pass, p);
    const float4 term = (float4)(weight * sum, (float)count);
    estimates[item] = start ? term : estimates[item] + term;
}

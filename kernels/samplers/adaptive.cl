// SPDX-License-Identifier: MIT
// Sampler adaptive: lights drawn from the nodes of the tile's cut by what each contributes to the
// pixel, and by what earlier passes saw of it from the pixel's cell.
#include "lib/cells.h"
#include "lib/direct.h"
#include "lib/inverse.h"
#include "lib/random.h"
#include "shared/light_tree.h"

#define LANES 1
#define NODES 1
#include "lib/node_estimate.h"
#undef LANES
#define LANES 16
#include "lib/node_estimate.h"
#undef NODES
#undef LANES
#include "lib/receivers_16.h"

// A node of several lights is expected to contribute as estimated, within a standard deviation of
// the root of this, relative: its lights differ.
#define GROUP_VARIANCE 0.5f
// The same for what is known of V^ and of areas, for a whole pixel.
#define PIXEL_VARIANCE 0.004f
// A node is replaced by its children where its weight times its angular size exceeds this share of
// the weight of one draw.
#define REFINED_SHARE 0.25f
#define MOST_SPLITS 64u
#define MOST_NODES (CUT_CAPACITY + MOST_SPLITS)

// A weighed node: as a drawn one, but for its mark, which says whether it is a single point.
#define SINGLE_POINT 0x800000u

static uint node_entry(__global const LightNode* nodes, uint node, uint slot) {
    const uint kind = nodes[node].kind;
    const bool point = kind != NODE_GROUP && kind != LIGHT_TRIANGLE && kind != LIGHT_QUAD;
    return (slot << 24) | node | (point ? SINGLE_POINT : 0u);
}

// The weights of 16 pixels' nodes, of which the first `size` are in use.
typedef struct Weights {
    float16 values[MOST_NODES];
    uint entries[MOST_NODES];
    uint size;
    float16 sum;
    Color_16 control;  // of V^ x estimate
} Weights;

static void add_color(Color_16* sum, Color_16 c, float16 factor) {
    sum->red = fma(c.red, factor, sum->red);
    sum->green = fma(c.green, factor, sum->green);
    sum->blue = fma(c.blue, factor, sum->blue);
}

// A node's contribution and its weight: the root of the mean square of what a shadow ray says of
// the contribution's luminance, less the control variate.
typedef struct Weighed {
    Color_16 color;
    float16 weight;
} Weighed;

static Weighed weigh(__global const LightNode* node, __global const Light* lights,
                     const Points_16* points, float16 visible) {
    const Node_1 own = load_node(node, lights);
    Weighed w;
    w.color = node_estimate_16(&own, points);
    const float whole = node->count > 1u ? 1.0f + GROUP_VARIANCE : 1.0f;
    const float16 square = visible * (whole - CONTROL * (2.0f - CONTROL) * visible);
    w.weight = color_luminance_16(w.color) * root_16(square);
    return w;
}

static void add_node(Weights* w, uint entry, const Weighed* own, float16 visible) {
    add_color(&w->control, own->color, visible);
    w->sum += own->weight;
    w->values[w->size] = own->weight;
    w->entries[w->size++] = entry;
}

// Whether any pixel wants the node's children: where its lights lie close, its estimate is coarse.
static bool wants_children(__global const LightNode* node, const Points_16* p, float16 weight,
                           float16 limit) {
    const float16 dx = node->centre.x - p->px, dy = node->centre.y - p->py,
                  dz = node->centre.z - p->pz;
    const float16 inverse = inverse_root_16(max(dot3_16(dx, dy, dz, dx, dy, dz), 1e-30f));
    const float16 near = NODE_IS_INFINITE(*node) ? (float16)(node->intensity.w)
                                                 : min(node->intensity.w * inverse, 1.0f);
    return lanes_16(weight * near > limit) != 0u;
}

// The weights of a cut of single lights.
static void weigh_lights(Weights* w, __global const LightNode* nodes, __global const Light* lights,
                         __global const uint* cut, uint cut_size, __global const float16* visible,
                         const Points_16* points, int16 valid) {
    for (uint slot = 0u; slot < cut_size; ++slot) {
        const float16 seen = select((float16)(0.0f), visible[slot], valid);
        const Weighed own = weigh(nodes + cut[slot], lights, points, seen);
        add_node(w, node_entry(nodes, cut[slot], slot), &own, seen);
    }
}

// The weights of a cut's nodes; what is close to a pixel is refined.
static void weigh_nodes(Weights* w, __global const LightNode* nodes, __global const Light* lights,
                        __global const uint* cut, uint cut_size, __global const float16* visible,
                        const Points_16* points, int16 valid, float samples) {
    const float16 zero = (float16)(0.0f);
    Weighed cut_weights[CUT_CAPACITY];
    float16 cut_sum = zero;
    for (uint slot = 0u; slot < cut_size; ++slot) {
        cut_weights[slot] =
            weigh(nodes + cut[slot], lights, points, select(zero, visible[slot], valid));
        cut_sum += cut_weights[slot].weight;
    }
    const float16 limit = cut_sum * (REFINED_SHARE / samples);
    uint stack[MOST_SPLITS + 1u];
    Weighed stack_weights[MOST_SPLITS + 1u];
    uint splits = 0u;
    for (uint slot = 0u; slot < cut_size; ++slot) {
        const float16 seen = select(zero, visible[slot], valid);
        stack[0] = cut[slot];
        stack_weights[0] = cut_weights[slot];
        for (uint top = 1u; top > 0u;) {
            const uint node = stack[--top];
            const Weighed own = stack_weights[top];
            if (nodes[node].count > 1u && splits < MOST_SPLITS &&
                wants_children(nodes + node, points, own.weight, limit)) {
                ++splits;
                const uint right = node + 2u * nodes[node + 1u].count;
                for (uint child = 0u; child < 2u; ++child) {  // the left one ends on top
                    const uint at = child == 0u ? right : node + 1u;
                    stack[top] = at;
                    stack_weights[top++] = weigh(nodes + at, lights, points, seen);
                }
                continue;
            }
            add_node(w, node_entry(nodes, node, slot), &own, seen);
        }
    }
}

// What one draw is expected to be like. Its mean square is the square of the weights' sum, its mean
// what the control variate leaves of the brightness.
static void expect(const Weights* w, float16* variance, float16* brightness) {
    *brightness = color_luminance_16(w->control);
    const float known = (1.0f - CONTROL) * (1.0f - CONTROL) - PIXEL_VARIANCE;
    *variance = max(w->sum * w->sum - known * *brightness * *brightness, 0.0f);
}

// Draws by the expected deviation of the pixel relative to its brightness, as relMSE weighs it.
// From one on a whole number, up or down by `rounding` in [0, 1): the number of draws adds no
// noise.
static float16 find_samples(const Weights* w, Budget budget, float16 rounding) {
    if (budget.factor == 0.0f) return (float16)(budget.samples);
    float16 variance, brightness;
    expect(w, &variance, &brightness);
    const float square = budget.exposure * budget.exposure;
    const float16 deviation =
        sqrt(variance * square / fma(brightness * brightness, (float16)(square), (float16)(0.01f)));
    const float16 samples = clamp(deviation * budget.factor, FEWEST_DRAWS * budget.samples,
                                  MOST_DRAWS * budget.samples);
    return select(samples, floor(samples + rounding), samples >= 1.0f);
}

// scale[lane], by which weights become expected numbers of draws, at most 1 where a node is one
// point, that add up to `samples`, or to the number of nodes if all are certain.
static float16 find_scale(const Weights* w, float16 samples) {
    // Just below, so that rounding never makes one draw too many.
    const float16 all = samples * 0.999999f;
    float16 scale = all / max(w->sum, 1e-30f);
    for (uint round = 0u; round < 8u; ++round) {
        float16 rest = (float16)(0.0f);
        float16 certain = (float16)(0.0f);
        for (uint i = 0u; i < w->size; ++i) {
            const float16 value = w->values[i];
            if (w->entries[i] & SINGLE_POINT) {
                const int16 is_certain = value * scale >= 1.0f;
                certain += select((float16)(0.0f), (float16)(1.0f), is_certain);
                rest += select(value, (float16)(0.0f), is_certain);
            } else {
                rest += value;
            }
        }
        // Where next to nothing is left for the rest, what is certain by the last scale stays so.
        const int16 possible = (rest > 0.0f) & (all - certain > 0.01f);
        const float16 next = select(scale, max((all - certain) / rest, scale), possible);
        if (!lanes_16(next > scale * 1.000001f)) break;
        scale = next;
    }
    return scale;
}

// Where in [0, 1) the systematic draws of pixels start: Jimenez' interleaved gradient noise
// ("Next Generation Post Processing in Call of Duty: Advanced Warfare", 2014), shifted at random
// for every pass: what a pass draws is independent of earlier ones, on which its weights depend.
static float16 draw_starts(uint16 x, uint16 y, float shift) {
    float16 whole;
    const float16 inner =
        fract(0.06711056f * convert_float16(x) + 0.00583715f * convert_float16(y), &whole);
    return min(fract(52.9829189f * inner + shift, &whole), 0x1.fffffep-1f);
}

// draws[], draw_counts[group]: the nodes drawn for the group's pixels, in the cut's order
// (lib/cells.h); pixel_packets[32 * group + cell]: the first of a pixel's packets of rays, and
// [... + 16]: their number; packet_counts[group]: those of the group; base[48 * group + 16 * rgb +
// cell]: the control variate of all nodes, cd/m2; expectations[] by pixels of the batch's pass.
// One group per work-item.
KERNEL void adaptive_draw(Tiles tiles, Camera camera, Pass pass, Budget budget,
                          __global const Surface* surfaces, __global const Material* materials,
                          __global const Light* lights, uint light_count,
                          __global const LightNode* nodes, __global const uint* cut_nodes,
                          __global const uint* cut_sizes, __global const float16* visible,
                          uint pixel_sample, uint seed, __global uint* draws,
                          __global uint* draw_counts, __global uint* pixel_packets,
                          __global uint* packet_counts, __global float16* base,
                          __global Expectation* expectations) {
    const uint group = get_global_id(0);
    if (group >= pass_groups(pass)) return;
    const uint quadrant = group / pass.count;  // of the run
    const uint tile = pass.first_tile + quadrant / 4u;
    const Receivers_16 receivers =
        load_receivers_16(tiles, pass, group, camera, surfaces, materials);
    const uint4 shifts =
        random_bits(16u * pass.number + pass.first, pixel_sample, RANDOM_DRAW_SHIFT, seed);
    float16 position = draw_starts(receivers.x, receivers.y, unit_float(shifts.x));
    const float16 rounding = draw_starts(receivers.y, receivers.x, unit_float(shifts.y));
    Weights w;
    w.size = 0u;
    w.sum = (float16)(0.0f);
    w.control.red = w.control.green = w.control.blue = (float16)(0.0f);
    uint16 counts = (uint16)(0u);  // of the pixels' draws
    uint size = 0u;                // of all of them
    if (lanes_16(receivers.valid)) {
        __global const float16* own_visible = visible + quadrant_slots(quadrant, light_count) / 16u;
        __global const uint* cut = cut_nodes + tile * CUT_CAPACITY;
        const uint cut_size = cut_sizes[tile];
        if (cut_size == light_count)
            weigh_lights(&w, nodes, lights, cut, cut_size, own_visible, &receivers.points,
                         receivers.valid);
        else
            weigh_nodes(&w, nodes, lights, cut, cut_size, own_visible, &receivers.points,
                        receivers.valid, budget.samples);
        const float16 scale = find_scale(&w, find_samples(&w, budget, rounding));
        for (uint i = 0u; i < w.size; ++i) {
            const uint entry = w.entries[i];
            float16 share = w.values[i] * scale;
            if (entry & SINGLE_POINT) share = min(share, 1.0f);
            const float16 reached = position + share;
            const float16 times = convert_float16(convert_int16(reached));
            position = reached - times;
            uint cells = lanes_16(times > 0.0f);
            if (!cells) continue;
            const float16 control = CONTROL * own_visible[DRAWN_SLOT(entry)] / share;
            for (; cells; cells &= cells - 1u) {
                const uint cell = lowest(cells);
                const uint number = UINT_LANE(counts, cell);
                const uint own_times = min((uint)LANE(times, cell), 16u * pass.packets - number);
                UINT_LANE(counts, cell) = number + own_times;
                for (uint k = 0u; k < own_times; ++k, ++size) {
                    __global uint* draw = draws + DRAW_ROW(pass, group, size, 0u) + size % 16u;
                    draw[16u * DRAW_ENTRY] = entry & ~SINGLE_POINT;
                    draw[16u * DRAW_CELL] = cell | (number + k) << 4 | k << 13 | own_times << 22;
                    draw[16u * DRAW_SHARE] = as_uint(LANE(share, cell));
                    draw[16u * DRAW_CONTROL] = as_uint(LANE(control, cell));
                }
            }
        }
    }
    draw_counts[group] = size;
    uint packet = group_packets(pass, group);
    for (uint cell = 0u; cell < 16u; ++cell) {
        const uint count = (UINT_LANE(counts, cell) + 15u) / 16u;
        pixel_packets[32u * group + cell] = packet;
        pixel_packets[32u * group + 16u + cell] = count;
        packet += count;
    }
    packet_counts[group] = packet - group_packets(pass, group);
    base[3u * group] = CONTROL * w.control.red;
    base[3u * group + 1u] = CONTROL * w.control.green;
    base[3u * group + 2u] = CONTROL * w.control.blue;
    float16 variance, brightness;
    expect(&w, &variance, &brightness);
    const uint first = 16u * (4u * pass.first_tile * pass.count + group);
    for (uint cell = 0u; cell < 16u; ++cell) {
        const Expectation e = {LANE(variance, cell), LANE(brightness, cell)};
        expectations[first + cell] = e;
    }
}

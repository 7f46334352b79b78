// SPDX-License-Identifier: MIT
// Sampler adaptive: lights drawn from the nodes of the tile's cut by what each contributes to the
// pixel, and by what earlier passes saw of it from the pixel's cell.
#include "lib/cells.h"
#include "lib/direct.h"
#include "lib/random.h"
#include "shared/light_tree.h"

#include "lib/node_estimate.h"
#define WIDE_POINTS 1
#include "lib/node_estimate.h"
#include "lib/receivers_n.h"

#define MOST_NODES (CUT_CAPACITY + MOST_SPLITS)

// A weighed node: as a drawn one, but for its mark, which says whether it is a single point.
#define SINGLE_POINT 0x800000u

static uint node_entry(__global const LightNode* nodes, uint node, uint slot) {
    const uint kind = nodes[node].kind;
    const bool point = kind != NODE_GROUP && !light_has(kind, TRAIT_AREA);
    return (slot << 24) | node | (point ? SINGLE_POINT : 0u);
}

// A node's estimated contribution C and its weight, C's luminance x sqrt(V (1 + s - k (2 - k) V)):
// V is V^, s the variance of C (GROUP_VARIANCE, or 0 for one light), k is CONTROL.
// A draw adds x C' - k V C, over its expected number: the ray passes (x = 1) with probability V,
// and C' has the expected value C and the relative variance s. Its mean square is
//     E[x C'^2] - 2 k V C E[x C'] + (k V C)^2 = C^2 (V (1 + s) - 2 k V^2 + k^2 V^2),
// and the variance of a sum of such terms is least where its draws follow the mean square's root.
typedef struct Weighed {
    Color_n color;
    float_n weight;
} Weighed;

// What the pixels of a group draw from.
typedef struct Source {
    __global const LightNode* nodes;
    __global const Light* lights;
    __global const uint* cut;
    uint cut_size;
    bool refines;  // nodes that are close to a pixel are replaced by their children
    __global const float* visible;  // V^ of the first pixel; 16 per slot
    Points_n points;
    int_n valid;
    float_n hidden;  // scales the weights of nodes that are believed hidden
    float_n limit;   // of the weight times the angular size of a node that is not refined
#if LANES > 1
    Weighed cut_weights[CUT_CAPACITY];
#endif
} Source;

INLINE float_n seen_of(const Source* s, uint slot) {
    return select((float_n)(0.0f), FLOATS_AT(s->visible + 16u * slot), s->valid);
}

// Whether a node is believed hidden.
INLINE int_n is_hidden(float_n visible) { return visible < HIDDEN_VISIBILITY; }

// V^ for the control variate: none of what is believed hidden.
INLINE float_n known_part(float_n visible) {
    return select(visible, (float_n)(0.0f), is_hidden(visible));
}

INLINE void add_color(Color_n* sum, Color_n c, float_n factor) {
    sum->red = fma(c.red, factor, sum->red);
    sum->green = fma(c.green, factor, sum->green);
    sum->blue = fma(c.blue, factor, sum->blue);
}

INLINE Weighed weigh(const Source* s, uint at, float_n visible) {
    __global const LightNode* node = s->nodes + at;
    const Node_1 own = load_node(node, s->lights);
    Weighed w;
    w.color = node_estimate_n(&own, &s->points);
    const float whole = node->count > 1u ? 1.0f + GROUP_VARIANCE : 1.0f;
    const float_n square =
        fabs(visible) * (whole - CONTROL * (2.0f - CONTROL) * known_part(visible));
    w.weight = color_luminance_n(w.color) * root_n(square) *
               select((float_n)(1.0f), s->hidden, is_hidden(visible));
    return w;
}

// Whether any pixel wants the node's children: where its lights lie close, its estimate is coarse.
INLINE bool wants_children(__global const LightNode* node, const Points_n* p, float_n weight,
                           float_n limit) {
    const float_n dx = node->centre.x - p->px, dy = node->centre.y - p->py,
                  dz = node->centre.z - p->pz;
    const float_n inverse = inverse_root_n(max(dot3_n(dx, dy, dz, dx, dy, dz), 1e-30f));
    const float_n near = NODE_IS_INFINITE(*node) ? (float_n)(node->intensity.w)
                                                 : min(node->intensity.w * inverse, 1.0f);
    return lanes_n(weight * near > limit) != 0u;
}

// Goes through the nodes that are drawn from, in the cut's order.
typedef struct Walk {
    uint next_slot, slot;
    uint top, splits;
    uint stack[MOST_SPLITS + 1u];
} Walk;

static void start_walk(Walk* w) { w->next_slot = w->top = w->splits = 0u; }

// Whether there is one more node; if so, the node and its weights.
INLINE bool next_node(const Source* s, Walk* w, uint* node, Weighed* own, float_n* seen) {
    while (w->top > 0u || w->next_slot < s->cut_size) {
        const bool is_cut = w->top == 0u;
        if (is_cut) w->slot = w->next_slot++;
        const uint at = is_cut ? s->cut[w->slot] : w->stack[--w->top];
        *seen = seen_of(s, w->slot);
#if LANES > 1
        if (is_cut)
            *own = s->cut_weights[w->slot];
        else
#endif
            *own = weigh(s, at, *seen);
        if (!s->refines || s->nodes[at].count == 1u || w->splits == MOST_SPLITS ||
            !wants_children(s->nodes + at, &s->points, own->weight, s->limit)) {
            *node = at;
            return true;
        }
        ++w->splits;
        w->stack[w->top++] = at + 2u * s->nodes[at + 1u].count;
        w->stack[w->top++] = at + 1u;
    }
    return false;
}

// The weights of a group's nodes. Vectors of them are kept; a work-item of a single pixel, of which
// many run at a time, has no room for that and finds them again whenever it needs them.
typedef struct Weights {
#if LANES > 1
    float_n values[MOST_NODES];
    uint entries[MOST_NODES];
    uint size;
#endif
    float_n sum;
    float_n largest_point;  // of nodes that are single points
    Color_n control;        // of V^ x estimate
} Weights;

// Goes through weights.
#if LANES > 1
typedef uint Place;
static void start_weights(Place* place) { *place = 0u; }
INLINE bool next_weight(const Weights* w, const Source* s, Place* place, uint* entry,
                        float_n* value) {
    if (*place == w->size) return false;
    *entry = w->entries[*place];
    *value = w->values[(*place)++];
    return true;
}
#else
typedef Walk Place;
static void start_weights(Place* place) { start_walk(place); }
INLINE bool next_weight(const Weights* w, const Source* s, Place* place, uint* entry,
                        float_n* value) {
    uint node;
    Weighed own;
    float_n seen;
    if (!next_node(s, place, &node, &own, &seen)) return false;
    *entry = node_entry(s->nodes, node, place->slot);
    *value = own.weight;
    return true;
}
#endif

static void find_weights(Weights* w, Source* s, float samples) {
    float_n open = (float_n)(0.0f), hidden = open;
    s->hidden = (float_n)(1.0f);
    for (uint slot = 0u; slot < s->cut_size; ++slot) {
        const float_n visible = seen_of(s, slot);
        const Weighed own = weigh(s, s->cut[slot], visible);
        open += select(own.weight, (float_n)(0.0f), is_hidden(visible));
        hidden += select((float_n)(0.0f), own.weight, is_hidden(visible));
#if LANES > 1
        s->cut_weights[slot] = own;
#endif
    }
    const float_n most = open * (HIDDEN_SHARE / (1.0f - HIDDEN_SHARE));
    s->hidden =
        select((float_n)(1.0f), most / max(hidden, 1e-30f), (hidden > most) & (most > 0.0f));
    s->limit = (open + hidden * s->hidden) * (REFINED_SHARE / samples);
#if LANES > 1
    for (uint slot = 0u; slot < s->cut_size; ++slot)
        s->cut_weights[slot].weight *=
            select((float_n)(1.0f), s->hidden, is_hidden(seen_of(s, slot)));
#endif
    w->sum = w->largest_point = (float_n)(0.0f);
    w->control.red = w->control.green = w->control.blue = (float_n)(0.0f);
#if LANES > 1
    w->size = 0u;
#endif
    Walk walk;
    start_walk(&walk);
    uint node;
    Weighed own;
    float_n seen;
    while (next_node(s, &walk, &node, &own, &seen)) {
        add_color(&w->control, own.color, known_part(seen));
        w->sum += own.weight;
        const uint entry = node_entry(s->nodes, node, walk.slot);
        if (entry & SINGLE_POINT) w->largest_point = max(w->largest_point, own.weight);
#if LANES > 1
        w->values[w->size] = own.weight;
        w->entries[w->size++] = entry;
#endif
    }
}

// Variance of one draw, and the pixel's expected brightness. The draw's mean square is the square
// of the weights' sum; its expected value is brightness x (1 - CONTROL), the rest being the control
// variate.
INLINE void expect(const Weights* w, float_n* variance, float_n* brightness) {
    *brightness = color_luminance_n(w->control);
    const float known = (1.0f - CONTROL) * (1.0f - CONTROL) - PIXEL_VARIANCE;
    *variance = max(w->sum * w->sum - known * *brightness * *brightness, 0.0f);
}

// Draws by the expected deviation of the pixel relative to its brightness, as relMSE weighs it.
// From one on a whole number, up or down by `rounding` in [0, 1): the number of draws adds no
// noise.
INLINE float_n find_samples(const Weights* w, Budget budget, float_n rounding) {
    if (budget.factor == 0.0f) return (float_n)(budget.samples);
    float_n variance, brightness;
    expect(w, &variance, &brightness);
    const float square = budget.exposure * budget.exposure;
    const float_n deviation =
        sqrt(variance * square / fma(brightness * brightness, (float_n)(square), (float_n)(0.01f)));
    const float_n samples = clamp(deviation * budget.factor, FEWEST_DRAWS * budget.samples,
                                  MOST_DRAWS * budget.samples);
    return select(samples, floor(samples + rounding), samples >= 1.0f);
}

// scale[lane], by which weights become expected numbers of draws, at most 1 where a node is one
// point, that add up to `samples`, or to the number of nodes if all are certain.
INLINE float_n find_scale(const Weights* w, const Source* s, float_n samples) {
    // Just below, so that rounding never makes one draw too many.
    const float_n all = samples * 0.999999f;
    float_n scale = all / max(w->sum, 1e-30f);
    for (uint round = 0u; round < 8u && lanes_n(w->largest_point * scale >= 1.0f); ++round) {
        float_n rest = (float_n)(0.0f);
        float_n certain = (float_n)(0.0f);
        Place place;
        start_weights(&place);
        uint entry;
        float_n value;
        while (next_weight(w, s, &place, &entry, &value)) {
            if (entry & SINGLE_POINT) {
                const int_n is_certain = value * scale >= 1.0f;
                certain += select((float_n)(0.0f), (float_n)(1.0f), is_certain);
                rest += select(value, (float_n)(0.0f), is_certain);
            } else {
                rest += value;
            }
        }
        // Where next to nothing is left for the rest, what is certain by the last scale stays so.
        const int_n possible = (rest > 0.0f) & (all - certain > 0.01f);
        const float_n next = select(scale, max((all - certain) / rest, scale), possible);
        if (!lanes_n(next > scale * 1.000001f)) break;
        scale = next;
    }
    return scale;
}

// Where in [0, 1) the systematic draws of pixels start: Jimenez' interleaved gradient noise
// ("Next Generation Post Processing in Call of Duty: Advanced Warfare", 2014), shifted at random
// for every pass: what a pass draws is independent of earlier ones, on which its weights depend.
INLINE float_n draw_starts(uint_n x, uint_n y, float shift) {
    float_n whole;
    const float_n inner =
        fract(0.06711056f * convert_float_n(x) + 0.00583715f * convert_float_n(y), &whole);
    return min(fract(52.9829189f * inner + shift, &whole), 0x1.fffffep-1f);
}

// draws[], draw_counts[group]: the nodes drawn for the group's pixels, in the cut's order
// (lib/cells.h); pixel_packets[2 * LANES * group + lane]: the first of a pixel's packets of rays,
// and [... + LANES]: their number; packet_counts[group]: those of the group; base[3 * LANES * group
// + LANES * rgb + lane]: the control variate of all nodes, cd/m2; expectations[] by pixels of the
// batch's pass. One group per work-item.
KERNEL void adaptive_draw(Tiles tiles, VIEW_PARAMETERS, Pass pass, Budget budget,
                          __global const Surface* surfaces, __global const Material* materials,
                          __global const Light* lights, uint light_count,
                          __global const LightNode* nodes, __global const uint* cut_nodes,
                          __global const uint* cut_sizes, __global const float* visible,
                          uint pixel_sample, uint seed, __global uint* draws,
                          __global uint* draw_counts, __global uint* pixel_packets,
                          __global uint* packet_counts, __global float_n* base,
                          __global Expectation* expectations) {
    const uint group = get_global_id(0);
    if (group >= pass_groups(pass)) return;
    const uint quadrant = group_quadrant(pass, group);
    const uint tile = pass.first_tile + quadrant / 4u;
    const Receivers_n receivers = load_receivers_n(tiles, pass, group, VIEW, surfaces, materials);
    const uint4 shifts =
        random_bits(16u * pass.number + pass.first, pixel_sample, RANDOM_DRAW_SHIFT, seed);
    float_n position = draw_starts(receivers.x, receivers.y, unit_float(shifts.x));
    const float_n rounding = draw_starts(receivers.y, receivers.x, unit_float(shifts.y));
    Source source;
    source.nodes = nodes;
    source.lights = lights;
    source.cut = cut_nodes + tile * CUT_CAPACITY;
    // Where no pixel sees anything, there is nothing to draw.
    source.cut_size = lanes_n(receivers.valid) ? cut_sizes[tile] : 0u;
    source.refines = source.cut_size != light_count;
    source.visible = visible + quadrant_slots(quadrant, light_count) + group_cell(group);
    source.points = receivers.points;
    source.valid = receivers.valid;
    Weights w;
    find_weights(&w, &source, budget.samples);
    const float_n scale = find_scale(&w, &source, find_samples(&w, budget, rounding));
    uint_n counts = (uint_n)(0u);  // of the pixels' draws
    uint size = 0u;                // of all of them
    Place place;
    start_weights(&place);
    uint entry;
    float_n value;
    while (next_weight(&w, &source, &place, &entry, &value)) {
        float_n share = value * scale;
        if (entry & SINGLE_POINT) share = min(share, 1.0f);
        const float_n reached = position + share;
        const float_n times = convert_float_n(convert_int_n(reached));
        position = reached - times;
        uint drawing = lanes_n(times > 0.0f);
        if (!drawing) continue;
        const float_n control =
            CONTROL * known_part(FLOATS_AT(source.visible + 16u * DRAWN_SLOT(entry))) / share;
        for (; drawing; drawing &= drawing - 1u) {
            const uint lane = lowest(drawing);
            const uint number = UINT_LANE(counts, lane);
            const uint own_times = min((uint)LANE(times, lane), 16u * pass.packets - number);
            UINT_LANE(counts, lane) = number + own_times;
            for (uint k = 0u; k < own_times; ++k, ++size) {
                __global uint* draw = draws + DRAW_ROW(pass, group, size, 0u) + size % 16u;
                draw[16u * DRAW_ENTRY] = entry & ~SINGLE_POINT;
                draw[16u * DRAW_LANE] = lane | (number + k) << 4 | k << 13 | own_times << 22;
                draw[16u * DRAW_SHARE] = as_uint(LANE(share, lane));
                draw[16u * DRAW_CONTROL] = as_uint(LANE(control, lane));
            }
        }
    }
    draw_counts[group] = size;
    uint packet = group_packets(pass, group);
    for (uint lane = 0u; lane < LANES; ++lane) {
        const uint count = (UINT_LANE(counts, lane) + 15u) / 16u;
        pixel_packets[2u * LANES * group + lane] = packet;
        pixel_packets[2u * LANES * group + LANES + lane] = count;
        packet += count;
    }
    packet_counts[group] = packet - group_packets(pass, group);
    base[3u * group] = CONTROL * w.control.red;
    base[3u * group + 1u] = CONTROL * w.control.green;
    base[3u * group + 2u] = CONTROL * w.control.blue;
    float_n variance, brightness;
    expect(&w, &variance, &brightness);
    const uint first = 16u * (4u * pass.first_tile * pass.count) + LANES * group;
    for (uint lane = 0u; lane < LANES; ++lane) {
        const Expectation e = {LANE(variance, lane), LANE(brightness, lane)};
        expectations[first + lane] = e;
    }
}

// SPDX-License-Identifier: MIT
// Sampler adaptive: lights drawn from the nodes of the tile's cut by what each contributes to the
// pixel, and by what earlier passes saw of it from the pixel's cell.
#include "lib/cells.h"
#include "lib/direct.h"
#include "lib/random.h"
#include "lib/rays.h"
#include "shared/light_tree.h"

#define LANES 1
#include "lib/node_estimate.h"
#undef LANES
#include "lib/points.h"
#define LANES 16
#include "lib/node_estimate.h"
#undef LANES

#include "lib/direct_16.h"

// The share of what is thought to be visible that is taken from the nodes' estimates rather than
// from shadow rays: a control variate.
#define CONTROL 0.8f
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

#define SET_POINT(field) ((float*)&all->field)[lane] = one.field

static void set_point(Points_16* all, uint lane, Points_1 one) {
    SET_POINT(px);
    SET_POINT(py);
    SET_POINT(pz);
    SET_POINT(nx);
    SET_POINT(ny);
    SET_POINT(nz);
    SET_POINT(red);
    SET_POINT(green);
    SET_POINT(blue);
#if HAS_GGX
    SET_POINT(vx);
    SET_POINT(vy);
    SET_POINT(vz);
    SET_POINT(metallic);
    SET_POINT(alpha);
    SET_POINT(specular);
#if HAS_REFLECTANCE
    SET_POINT(f0_red);
    SET_POINT(f0_green);
    SET_POINT(f0_blue);
#endif
    all->glossy = all->glossy || one.glossy;
#endif
}

static void set_origin(Origins_16* all, uint lane, float3 origin, float3 geometric) {
    SET_LANE(all->x, lane, origin.x);
    SET_LANE(all->y, lane, origin.y);
    SET_LANE(all->z, lane, origin.z);
    SET_LANE(all->gx, lane, geometric.x);
    SET_LANE(all->gy, lane, geometric.y);
    SET_LANE(all->gz, lane, geometric.z);
}

// Points on a light at random.
static void random_points(uint16 pixels, uint pixel_sample, uint16 dimensions, uint seed,
                          float16* u, float16* v) {
    uint16 bits[4];
    random_bits_16(pixels, pixel_sample, dimensions, seed, bits);
    *u = convert_float16(bits[1] >> 8u) * 0x1p-24f;
    *v = convert_float16(bits[2] >> 8u) * 0x1p-24f;
}

// A draw's ray, and what it contributes where nothing is in its way (lib/samples.h).
static void put_sample(__global float* rays, __global float* values, uint place, const Direct_16* d,
                       uint cell) {
    __global float* row = rays + 64 * (ulong)(place / 16u) + place % 16u;
    row[0] = LANE(d->x, cell);
    row[16] = LANE(d->y, cell);
    row[32] = LANE(d->z, cell);
    row[48] = d->end;
    __global float* lanes = values + 48 * (ulong)(place / 16u) + place % 16u;
    lanes[0] = LANE(d->value.red, cell);
    lanes[16] = LANE(d->value.green, cell);
    lanes[32] = LANE(d->value.blue, cell);
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
    Weighed w;
    w.color = node_estimate_16(node, lights, points);
    const float whole = node->count > 1u ? 1.0f + GROUP_VARIANCE : 1.0f;
    const float16 square = visible * (whole - CONTROL * (2.0f - CONTROL) * visible);
    w.weight = color_luminance_16(w.color) * sqrt(square);
    return w;
}

// Whether any pixel wants the node's children: where its lights lie close, its estimate is coarse.
static bool wants_children(__global const LightNode* node, const Points_16* p, float16 weight,
                           float16 limit) {
    const float16 dx = node->centre.x - p->px, dy = node->centre.y - p->py,
                  dz = node->centre.z - p->pz;
    const float16 inverse = 1.0f / sqrt(max(fma(dx, dx, fma(dy, dy, dz * dz)), 1e-30f));
    const float16 near =
        node->infinite ? (float16)(node->intensity.w) : min(node->intensity.w * inverse, 1.0f);
    return lanes_16(weight * near > limit) != 0u;
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
            add_color(&w->control, own.color, seen);
            w->sum += own.weight;
            w->values[w->size] = own.weight;
            w->entries[w->size++] = node_entry(nodes, node, slot);
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

// Where in [0, 1) the systematic draw of a pixel starts: Jimenez' interleaved gradient noise
// ("Next Generation Post Processing in Call of Duty: Advanced Warfare", 2014), shifted at random
// for every pass: what a pass draws is independent of earlier ones, on which its weights depend.
static float draw_start(uint2 pixel, float shift) {
    float whole;
    const float inner = fract(0.06711056f * (float)pixel.x + 0.00583715f * (float)pixel.y, &whole);
    return min(fract(52.9829189f * inner + shift, &whole), 0x1.fffffep-1f);
}

// drawn[first_draw(p) + i] and shares[...]: the nodes drawn for pixel p of the pass and how often
// each is expected to be drawn; base[p]: what the control variate adds, cd/m2; expectations[] by
// pixels of the batch's pass. 16 pixels, the same place of a quadrant's cells, per work-item.
KERNEL void adaptive_draw(Tiles tiles, Camera camera, Pass pass, Budget budget,
                          __global const Surface* surfaces, __global const Material* materials,
                          __global const Light* lights, __global const LightNode* nodes,
                          __global const uint* cut_nodes, __global const uint* cut_sizes,
                          __global const float16* visible, uint pixel_sample, uint seed,
                          __global uint* drawn, __global float* shares, __global float4* base,
                          __global Expectation* expectations, __global float4* origins,
                          __global float* rays, __global float* values) {
    const uint local_quadrant = get_global_id(0) / pass.count;
    const uint place = get_global_id(0) % pass.count;
    if (local_quadrant >= 4u * pass.tile_count) return;
    const uint tile = pass.first_tile + local_quadrant / 4u;
    const uint quadrant = 4u * pass.first_tile + local_quadrant;
    Points_16 points;
    Origins_16 from;
    uint16 pixels = (uint16)(0u);
#if HAS_GGX
    points.glossy = false;
#endif
    bool reflecting = false;
    int16 valid = (int16)(0);
    float16 position = (float16)(0.0f);
    float16 rounding = (float16)(0.0f);
    const uint4 shifts =
        random_bits(16u * pass.number + pass.first, pixel_sample, RANDOM_DRAW_SHIFT, seed);
    for (uint cell = 0u; cell < 16u; ++cell) {
        const uint item = pass_item(pass, (16u * local_quadrant + cell) * pass.count + place);
        const bool hit = item_in_image(tiles, item) && !surface_missed(surfaces + item);
        INT_LANE(valid, cell) = hit ? -1 : 0;
        Receiver receiver;
        if (hit) {
            receiver = make_receiver(surfaces + item, materials, camera);
            const uint2 pixel = item_pixel(tiles, item);
            SET_LANE(position, cell, draw_start(pixel, unit_float(shifts.x)));
            SET_LANE(rounding, cell, draw_start(pixel.yx, unit_float(shifts.y)));
            UINT_LANE(pixels, cell) = pixel.y * tiles.width + pixel.x;
        } else {
            receiver.position = receiver.normal = receiver.to_camera = (float3)(1.0f);
            receiver.geometric = receiver.normal;
            receiver.offset = 0.0f;
            receiver.reflects = false;
            receiver.material.base_color = (float4)(0.0f);
            receiver.material.roughness = 1.0f;
            receiver.material.specular = 0.0f;
            receiver.material.reflectance = (float4)(0.0f);
        }
        reflecting = reflecting || receiver.reflects;
        set_point(&points, cell, point_of(&receiver));
        const float3 origin = shadow_origin(&receiver);
        set_origin(&from, cell, origin, receiver.geometric);
        const uint p = (16u * local_quadrant + cell) * pass.count + place;
        for (uint k = 0u; k < pass.packets; ++k) {
            clear_packet(rays, pass.packets * p + k);
            origins[pass.packets * p + k] = (float4)(origin, 0.0f);
        }
    }
    uint16 counts = (uint16)(0u);
    Weights w;
    w.size = 0u;
    w.sum = (float16)(0.0f);
    w.control.red = w.control.green = w.control.blue = (float16)(0.0f);
    const uint capacity = 16u * pass.packets;
    const uint first_pixel = 16u * local_quadrant * pass.count + place;
    __global const float16* own_visible = visible + quadrant_slots(quadrant) / 16u;
    Color_16 drawn_control = {0.0f, 0.0f, 0.0f};  // of what is drawn, over how often it is
    if (lanes_16(valid)) {
        weigh_nodes(&w, nodes, lights, cut_nodes + tile * CUT_CAPACITY, cut_sizes[tile],
                    own_visible, &points, valid, budget.samples);
        const float16 scale = find_scale(&w, find_samples(&w, budget, rounding));
        for (uint i = 0u; i < w.size; ++i) {
            const uint entry = w.entries[i];
            float16 share = w.values[i] * scale;
            if (entry & SINGLE_POINT) share = min(share, 1.0f);
            const float16 reached = position + share;
            const float16 times = floor(reached);
            position = reached - times;
            uint cells = lanes_16(times > 0.0f);
            if (!cells) continue;
            const float16 factor = own_visible[DRAWN_SLOT(entry)] * times / max(share, 1e-30f);
            add_color(&drawn_control, node_estimate_16(nodes + DRAWN_NODE(entry), lights, &points),
                      select((float16)(0.0f), factor, times > 0.0f));
            const uint node = DRAWN_NODE(entry);
            const bool point = (entry & SINGLE_POINT) != 0u;
            // What stage reflections shares is left to adaptive_aim().
            const bool single = nodes[node].count == 1u && (point || !reflecting);
            const uint mark = (entry & ~SINGLE_POINT) | (single ? AIMED : 0u);
            for (float16 left = times; cells; cells = lanes_16(left > 0.0f)) {
                left -= 1.0f;
                Direct_16 d;
                uint lit = 0u;
                if (single) {
                    float16 u = (float16)(0.5f), v = u;
                    if (!point)
                        random_points(pixels, pixel_sample, RANDOM_DRAWS * pass.number + counts,
                                      seed, &u, &v);
                    d = direct_16(lights + nodes[node].first, nodes[node].kind, &points, &from, u,
                                  v);
                    lit = lanes_16(d.value.red + d.value.green + d.value.blue > 0.0f);
                    const float16 inverse = 1.0f / max(share, 1e-30f);
                    d.value.red *= inverse;
                    d.value.green *= inverse;
                    d.value.blue *= inverse;
                }
                for (; cells; cells &= cells - 1u) {
                    const uint cell = lowest(cells);
                    const uint p = first_pixel + cell * pass.count;
                    const uint i = UINT_LANE(counts, cell);
                    if (i == capacity) continue;
                    UINT_LANE(counts, cell) = i + 1u;
                    drawn[capacity * p + i] = mark;
                    shares[capacity * p + i] = LANE(share, cell);
                    if (lit >> cell & 1u) put_sample(rays, values, capacity * p + i, &d, cell);
                }
            }
        }
    }
    float16 variance, brightness;
    expect(&w, &variance, &brightness);
    for (uint cell = 0u; cell < 16u; ++cell) {
        const uint p = (16u * local_quadrant + cell) * pass.count + place;
        const uint count = UINT_LANE(counts, cell);
        if (count < capacity) drawn[first_draw(pass, p) + count] = NO_DRAW;
        base[p] =
            CONTROL * (float4)(LANE(w.control.red, cell) - LANE(drawn_control.red, cell),
                               LANE(w.control.green, cell) - LANE(drawn_control.green, cell),
                               LANE(w.control.blue, cell) - LANE(drawn_control.blue, cell), 0.0f);
        const Expectation e = {LANE(variance, cell), LANE(brightness, cell)};
        expectations[(16u * quadrant + cell) * pass.count + place] = e;
    }
}

// A light of a node, drawn child by child by their estimates. Weight 0: none can contribute.
typedef struct Descent {
    uint light;
    float probability;
} Descent;

static Descent descend(__global const LightNode* nodes, __global const Light* lights,
                       const Points_1* point, uint node, float u, uint bits) {
    Descent d = {0u, 1.0f};
    for (uint step = 0u; nodes[node].count > 1u; ++step) {
        const uint right = node + 2u * nodes[node + 1u].count;
        const float a = color_luminance_1(node_estimate_1(nodes + node + 1u, lights, point));
        const float b = color_luminance_1(node_estimate_1(nodes + right, lights, point));
        if (!(a + b > 0.0f)) {
            d.probability = 0.0f;
            return d;
        }
        if (step > 0u) u = unit_float(step_bits(bits, step));
        const float p = a / (a + b);
        const bool go_left = u < p;
        d.probability *= go_left ? p : b / (a + b);
        node = go_left ? node + 1u : right;
    }
    d.light = nodes[node].first;
    return d;
}

// Draws a light for each drawn node whose ray is not made yet, and its ray: draw i of pixel p is
// lane i % 16 of packet pass.packets * p + i / 16; values as in lib/samples.h. One pixel of the
// pass per work-item.
KERNEL void adaptive_aim(Tiles tiles, Camera camera, Pass pass, __global const Surface* surfaces,
                         __global const Material* materials, __global const Light* lights,
                         __global const LightNode* nodes, uint pixel_sample, uint seed,
                         __global const uint* drawn, __global const float* shares,
                         __global float* rays, __global float* values) {
    const uint p = get_global_id(0);
    if (p >= pass_pixels(pass)) return;
    const uint capacity = 16u * pass.packets;
    __global const uint* own_draws = drawn + first_draw(pass, p);
    if (own_draws[0] == NO_DRAW) return;
    const uint item = pass_item(pass, p);
    const Receiver receiver = make_receiver(surfaces + item, materials, camera);
    const Points_1 point = point_of(&receiver);
    const uint2 pixel = item_pixel(tiles, item);
    uint first = 0u;  // of the draws of the same node
    uint same = 0u;   // their number
    for (uint i = 0u; i < capacity && own_draws[i] != NO_DRAW; ++i) {
        const uint entry = own_draws[i];
        if (entry & AIMED) continue;
        if (i >= first + same) {
            first = i;
            for (same = 1u; first + same < capacity; ++same)
                if (own_draws[first + same] != entry) break;
        }
        const uint4 bits = random_bits(pixel.y * tiles.width + pixel.x, pixel_sample,
                                       RANDOM_DRAWS * pass.number + i, seed);
        const float u = ((float)(i - first) + unit_float(bits.x)) / (float)same;
        const Descent d = descend(nodes, lights, &point, DRAWN_NODE(entry), u, bits.w);
        if (d.probability == 0.0f) continue;
        Ray shadow;
        const float2 on_light = (float2)(unit_float(bits.y), unit_float(bits.z));
        const float3 value = unshadowed(&receiver, lights + d.light, on_light, &shadow) /
                             (shares[first_draw(pass, p) + i] * d.probability);
        if (!any(value != 0.0f)) continue;
        const ulong packet = pass.packets * p + i / 16u;
        put_ray(rays, packet, i % 16u, shadow);
        __global float* lanes = values + 48 * packet + i % 16u;
        lanes[0] = value.x;
        lanes[16] = value.y;
        lanes[32] = value.z;
    }
}

// estimates[item], cd/m2, and in w the number of rays, of the pass's pixels: base plus what is
// visible. `weight` of this draw is added to what is there, unless `start` says that it is the
// first.
KERNEL void adaptive_add(Pass pass, __global const uint* drawn, __global const float4* base,
                         __global const float* rays, __global const float* values, float weight,
                         uint start, __global float4* estimates) {
    const uint p = get_global_id(0);
    if (p >= pass_pixels(pass)) return;
    const uint item = pass_item(pass, p);
    float4 sum = base[p];
    float count = 0.0f;
    for (uint i = 0u; i < 16u * pass.packets; ++i) {
        if (drawn[first_draw(pass, p) + i] == NO_DRAW) break;
        const uint packet = pass.packets * p + i / 16u;
        const float end = RAY_END(rays, packet, i % 16u);
        if (end == 0.0f) continue;
        count += 1.0f;
        __global const float* lanes = values + 48 * (ulong)packet + i % 16u;
        if (end > 0.0f) sum.xyz += (float3)(lanes[0], lanes[16], lanes[32]);
    }
    const float4 term = (float4)(weight * sum.xyz, count);
    estimates[item] = start ? term : estimates[item] + term;
}

// SPDX-License-Identifier: MIT
// Sampler contribution-cached: the CDFs of the pixel's cluster and of those nearest to it, mixed
// (importance caching: Georgiev, Křivánek, Popov, Slusallek, "Importance Caching for Complex
// Illumination", 2012).
#include "lib/direct.h"
#include "lib/draw.h"
#include "samplers/contribution_cached/nearest.h"

// The pixel's state are the rows that it draws from, its own first.
// cdf[item_rows[item] * light_count + light]; neighbours, places: see neighbours.cl
#define PIXEL_STATE Nearest
#define SAMPLER_PARAMETERS                                                                       \
    , __global const uint *cdf, __global const uint *item_rows, __global const uint *neighbours, \
        __global const float4 *places, uint most_rows
#define SAMPLER_ARGUMENTS , cdf, item_rows, neighbours, places, most_rows
#define CLOSED_FORM

static uint row_total(__global const uint* cdf, uint row, uint light_count) {
    return cdf[(ulong)row * light_count + light_count - 1u];
}

static float probability_in(__global const uint* cdf, uint row, uint light_count, uint light) {
    return (float)cdf_width(cdf + (ulong)row * light_count, light) /
           (float)row_total(cdf, row, light_count);
}

// Its cluster's own row and the `most_rows` - 1 of its neighbours whose representatives are nearest
// to the point, nearest first; but no row without a light.
static void begin_pixel(const Receiver* receiver, __global const Light* lights, Draw first,
                        __global const uint* cdf, __global const uint* item_rows,
                        __global const uint* neighbours, __global const float4* places,
                        uint most_rows, Nearest* rows) {
    const uint own = item_rows[first.item];
    rows->count = 0u;
    if (row_total(cdf, own, first.light_count) > 0u) add_row(rows, most_rows, own, 0.0f);
    for (uint k = 0u; k < MOST_NEIGHBOURS; ++k) {
        const uint row = neighbours[MOST_NEIGHBOURS * (ulong)own + k];
        if (row == NO_ROW) break;
        if (row_total(cdf, row, first.light_count) == 0u) continue;
        const float3 apart = places[row].xyz - receiver->position;
        add_row(rows, most_rows, row, dot(apart, apart));
    }
}

// Of all rows, where there are any: the own row has as many light samples as the others together.
static float mixed_probability(const Nearest* rows, __global const uint* cdf, uint light_count,
                               uint light) {
    const uint others = rows->count - 1u;
    float probability = 0.0f;
    for (uint k = others; k > 0u; --k)
        probability += probability_in(cdf, rows->rows[k], light_count, light);
    const float own = probability_in(cdf, rows->rows[0], light_count, light);
    return others > 0u ? 0.5f * (own + probability / (float)others) : own;
}

// A light of one of the rows, its own for half of all light samples, by the probability that it has
// of all of them: the balance heuristic for one sample.
static Choice choose_light(const Receiver* receiver, __global const Light* lights, Draw draw,
                           __global const uint* cdf, __global const uint* item_rows,
                           __global const uint* neighbours, __global const float4* places,
                           uint most_rows, const Nearest* rows) {
    Choice choice = {0u, 0.0f};
    if (rows->count == 0u) return choice;
    const uint others = rows->count - 1u;
    // Its own row has as many places as all others together.
    const uint place = mul_hi(draw.bits.w, 2u * others);
    const uint drawn = rows->rows[place < others || others == 0u ? 0u : place - others + 1u];
    choice = draw_from_cdf(cdf + (ulong)drawn * draw.light_count, draw);
    const float probability = mixed_probability(rows, cdf, draw.light_count, choice.light);
    choice.weight = 1.0f / (probability * (float)draw.sample_count);
    return choice;
}

static float light_probability(const Receiver* receiver, __global const Light* lights, Draw draw,
                               uint light, __global const uint* cdf, __global const uint* item_rows,
                               __global const uint* neighbours, __global const float4* places,
                               uint most_rows, const Nearest* rows) {
    return rows->count == 0u ? 0.0f : mixed_probability(rows, cdf, draw.light_count, light);
}

#include "lib/samples.h"

#include "lib/reflected.h"

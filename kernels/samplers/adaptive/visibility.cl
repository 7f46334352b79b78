// SPDX-License-Identifier: MIT
// Stage visibility: what shadow rays have said about the nodes of a tile's cut, cell by cell, and
// the estimate V^ of the share of a node's light that a cell sees.
#include "lib/cells.h"
#include "lib/inverse.h"
#include "lib/rays.h"
#include "shared/light_tree.h"

// Rays traced and passed share a word: counts[...] = traced + 65536 passed. A count ends here, long
// before it overflows.
#define MOST_TRIALS 60000u

// Adds the rays of a pass to the counts of its cells. One quadrant per work-item.
KERNEL void visibility_learn(Pass pass, __global const uint* draws,
                             __global const uint* draw_counts, __global const uint* pixel_packets,
                             __global const float* rays, uint light_count, __global uint* counts) {
    const uint quadrant = get_global_id(0);
    if (quadrant >= 4u * pass.tile_count) return;
    __global uint* own = counts + quadrant_slots(4u * pass.first_tile + quadrant, light_count);
    const uint groups = 16u / LANES * pass.count;
    for (uint group = quadrant * groups; group < (quadrant + 1u) * groups; ++group) {
        __global const uint* first_packets = pixel_packets + 2u * LANES * group;
        for (uint draw = 0u; draw < draw_counts[group]; ++draw) {
            const uint bits = draws[DRAW_ROW(pass, group, draw, DRAW_LANE) + draw % 16u];
            const uint lane = bits & 15u, number = bits >> 4 & 0x1ffu;
            const float end = RAY_END(rays, first_packets[lane] + number / 16u, number % 16u);
            if (end == 0.0f) continue;
            const uint slot =
                DRAWN_SLOT(draws[DRAW_ROW(pass, group, draw, DRAW_ENTRY) + draw % 16u]);
            __global uint* count = own + 16u * slot + group_cell(group) + lane;
            if ((*count & 0xffffu) < MOST_TRIALS) *count += end > 0.0f ? 65537u : 1u;
        }
    }
}

// Rays of cells.
typedef struct CellTrials {
    float_n traced, passed;
} CellTrials;

INLINE CellTrials load_trials(uint_n counts) {
    CellTrials t;
    t.traced = convert_float_n(counts & 0xffffu);
    t.passed = convert_float_n(counts >> 16);
    return t;
}

// The rays of a slot in the quadrants' cells from `cell` on, in the 4 x 4 of them that each is one
// of, and in the whole quadrant. `counts`: of the quadrant's 16 cells.
INLINE CellTrials of_cells(__global const uint* counts, uint cell) {
    return load_trials(UINTS_AT(counts + cell));
}

#if LANES == 16
#define SWAP_1(v) (v).s1032547698badcfe
#define SWAP_2(v) (v).s23016745ab89efcd
#elif LANES == 8
#define SWAP_1(v) (v).s10325476
#define SWAP_2(v) (v).s23016745
#elif LANES == 4
#define SWAP_1(v) (v).s1032
#define SWAP_2(v) (v).s2301
#endif

INLINE CellTrials of_quarters(__global const uint* counts, uint cell) {
#if LANES > 1
    CellTrials t = of_cells(counts, cell);
    t.traced += SWAP_1(t.traced);
    t.traced += SWAP_2(t.traced);
    t.passed += SWAP_1(t.passed);
    t.passed += SWAP_2(t.passed);
#else
    CellTrials t = {0.0f, 0.0f};
    for (uint i = cell & ~3u; i < (cell & ~3u) + 4u; ++i) {
        t.traced += (float)(counts[i] & 0xffffu);
        t.passed += (float)(counts[i] >> 16);
    }
#endif
    return t;
}

static Trials of_quadrant(__global const uint* counts) {
    CellTrials t = of_cells(counts, 0u);
    for (uint cell = LANES; cell < 16u; cell += LANES) {
        const CellTrials more = of_cells(counts, cell);
        t.traced += more.traced;
        t.passed += more.passed;
    }
    const Trials sum = {sum_of(t.traced), sum_of(t.passed)};
    return sum;
}

// A slot's trials in a whole tile: those of the cut (stage cuts) and of the cells. One slot per
// work-item.
KERNEL void visibility_sum(Tiles tiles, __global const uint* cut_sizes,
                           __global const Trials* probes, __global const uint* counts,
                           uint light_count, __global Trials* totals) {
    const uint tile = get_global_id(0) / CUT_CAPACITY;
    const uint slot = get_global_id(0) % CUT_CAPACITY;
    if (tile >= tiles.count || slot >= cut_sizes[tile]) return;
    Trials total = probes[tile * CUT_CAPACITY + slot];
    for (uint quadrant = 4u * tile; quadrant < 4u * tile + 4u; ++quadrant) {
        const Trials own = of_quadrant(counts + quadrant_slots(quadrant, light_count) + 16u * slot);
        total.traced += own.traced;
        total.passed += own.passed;
    }
    totals[tile * CUT_CAPACITY + slot] = total;
}

// The slot of a tile's cut whose node holds a light.
static uint find_slot(__global const uint* cut, uint size, __global const LightNode* nodes,
                      uint light) {
    uint slot = 0u;
    for (uint count = size; count > 1u;) {
        const uint half_count = count / 2u;
        if (nodes[cut[slot + half_count]].first <= light) slot += half_count;
        count -= half_count;
    }
    return slot;
}

// shared[...]: a slot's trials with those that the four neighbouring tiles of the run lend it, by
// the lights that their nodes have in common with it. One slot per work-item.
KERNEL void visibility_share(Tiles tiles, __global const LightNode* nodes,
                             __global const uint* cut_nodes, __global const uint* cut_sizes,
                             __global const Trials* totals, __global Trials* shared) {
    const uint tile = get_global_id(0) / CUT_CAPACITY;
    const uint slot = get_global_id(0) % CUT_CAPACITY;
    if (tile >= tiles.count || slot >= cut_sizes[tile]) return;
    __global const LightNode* node = nodes + cut_nodes[tile * CUT_CAPACITY + slot];
    const uint end = node->first + node->count;
    const int column = (tiles.first + tile) % tiles.columns;
    Trials lent = {0.0f, 0.0f};
    for (uint side = 0u; side < 4u; ++side) {
        const int step = side % 2u == 0u ? 1 : -1;
        const int other = (int)tile + (side < 2u ? step : step * (int)tiles.columns);
        const bool leaves_row =
            side < 2u && (column + step < 0 || column + step >= (int)tiles.columns);
        if (leaves_row || other < 0 || other >= (int)tiles.count) continue;
        const uint size = cut_sizes[other];
        if (size == 0u) continue;
        __global const uint* cut = cut_nodes + other * CUT_CAPACITY;
        for (uint i = find_slot(cut, size, nodes, node->first); i < size; ++i) {
            const uint first = nodes[cut[i]].first;
            const uint count = nodes[cut[i]].count;
            if (first >= end) break;
            const uint common = min(first + count, end) - max(first, node->first);
            const float share = (float)common / (float)count;
            const Trials theirs = totals[other * CUT_CAPACITY + i];
            lent.traced += share * theirs.traced;
            lent.passed += share * theirs.passed;
        }
    }
    const float scale = lent.traced > MOST_LENT ? MOST_LENT / lent.traced : 1.0f;
    Trials sum = totals[tile * CUT_CAPACITY + slot];
    sum.traced += scale * lent.traced;
    sum.passed += scale * lent.passed;
    shared[tile * CUT_CAPACITY + slot] = sum;
}

static float shrink(Trials trials, float towards, float rays) {
    return (trials.passed + rays * towards) / (trials.traced + rays);
}

static void add_trials(Trials* sum, Trials term) {
    sum->traced += term.traced;
    sum->passed += term.passed;
}

INLINE float_n shrink_n(float_n traced, float_n passed, float_n towards) {
    return (passed + PARENT_RAYS * towards) * inverse_n(traced + PARENT_RAYS);
}

// The rays from a part of a tile to all slots: traced, passed, and expected to pass.
typedef struct Outcome {
    float_n traced, passed, expected;
} Outcome;

INLINE void add_outcome(Outcome* sum, float_n traced, float_n passed, float_n share) {
    sum->traced += traced;
    sum->passed += passed;
    sum->expected = fma(traced, share, sum->expected);
}

// Ratios of observed to expected rays, passed and stopped, of all slots in a part of a tile. They
// scale the odds of every slot's visibility there, since lights are often hidden together.
typedef struct Odds {
    float_n passed, stopped;
} Odds;

INLINE Odds odds_of(const Outcome* seen) {
    Odds odds;
    odds.passed = (seen->passed + SIGHT_RAYS) / (seen->expected + SIGHT_RAYS);
    odds.stopped =
        (seen->traced - seen->passed + SIGHT_RAYS) / (seen->traced - seen->expected + SIGHT_RAYS);
    return odds;
}

INLINE float_n adjust(Odds odds, float_n share) {
    const float_n yes = share * odds.passed;
    return yes * inverse_n(fma(1.0f - share, odds.stopped, yes));
}

// visible[...] = V^ of every cell, by shrinkage down a hierarchy: the tile, SLOT_GROUP slots, the
// slot, then the slot from 16 x 16, 8 x 8 and 4 x 4 pixels. The prior of each level is the estimate
// of the one above, its odds adjusted to the part's rays to all slots (Odds). Negative as long as
// no ray to the slot has passed. Of tile_count tiles
// from first_tile on; visible[] holds these alone. LANES cells of a quadrant (16 x 16 pixels) per
// work-item.
KERNEL void visibility_estimate(uint first_tile, uint tile_count, __global const uint* cut_sizes,
                                __global const Trials* shared, __global const uint* counts,
                                uint light_count, __global float* visible) {
    const uint quadrant = LANES * (uint)get_global_id(0) / 16u;
    const uint cell = LANES * (uint)get_global_id(0) % 16u;
    if (quadrant >= 4u * tile_count) return;
    const uint tile = first_tile + quadrant / 4u;
    const uint size = cut_sizes[tile];
    __global const Trials* own = shared + tile * CUT_CAPACITY;
    __global const uint* own_counts =
        counts + quadrant_slots(4u * first_tile + quadrant, light_count);
    __global float_n* own_visible =
        (__global float_n*)(visible + quadrant_slots(quadrant, light_count) + cell);
    const uint stride = 16u / LANES;  // from slot to slot
    const float_n zero = (float_n)(0.0f);
    Trials all = {0.0f, 0.0f};
    for (uint slot = 0u; slot < size; ++slot) add_trials(&all, own[slot]);
    const float tile_share = shrink(all, PRIOR_SHARE, 1.0f);
    float group_share = 0.0f;
    Outcome of_16 = {zero, zero, zero}, of_8 = of_16, of_4 = of_16;
    for (uint slot = 0u; slot < size; ++slot) {
        if (slot % SLOT_GROUP == 0u) {
            Trials group = {0.0f, 0.0f};
            for (uint i = slot; i < min(slot + SLOT_GROUP, size); ++i) add_trials(&group, own[i]);
            group_share = shrink(group, tile_share, 1.0f);
        }
        const float_n share = (float_n)(shrink(own[slot], group_share, 1.0f));
        const Trials t = of_quadrant(own_counts + 16u * slot);
        add_outcome(&of_16, (float_n)(t.traced), (float_n)(t.passed), share);
        own_visible[stride * slot] = share;
    }
    Odds odds = odds_of(&of_16);
    for (uint slot = 0u; slot < size; ++slot) {
        const Trials of_all = of_quadrant(own_counts + 16u * slot);
        const CellTrials t = of_quarters(own_counts + 16u * slot, cell);
        const float_n share = shrink_n((float_n)(of_all.traced), (float_n)(of_all.passed),
                                       adjust(odds, own_visible[stride * slot]));
        add_outcome(&of_8, t.traced, t.passed, share);
        own_visible[stride * slot] = share;
    }
    odds = odds_of(&of_8);
    for (uint slot = 0u; slot < size; ++slot) {
        const CellTrials of_part = of_quarters(own_counts + 16u * slot, cell);
        const CellTrials t = of_cells(own_counts + 16u * slot, cell);
        const float_n share =
            shrink_n(of_part.traced, of_part.passed, adjust(odds, own_visible[stride * slot]));
        add_outcome(&of_4, t.traced, t.passed, share);
        own_visible[stride * slot] = share;
    }
    odds = odds_of(&of_4);
    for (uint slot = 0u; slot < size; ++slot) {
        const CellTrials t = of_cells(own_counts + 16u * slot, cell);
        const float_n share =
            shrink_n(t.traced, t.passed, adjust(odds, own_visible[stride * slot]));
        const float_n seen = max(share, LEAST_VISIBILITY);
        own_visible[stride * slot] = own[slot].passed >= SEEN_RAYS ? seen : -seen;
    }
}

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
    for (uint group = quadrant * pass.count; group < (quadrant + 1u) * pass.count; ++group) {
        __global const uint* first_packets = pixel_packets + 32u * group;
        for (uint draw = 0u; draw < draw_counts[group]; ++draw) {
            const uint cell_bits = draws[DRAW_ROW(pass, group, draw, DRAW_CELL) + draw % 16u];
            const uint cell = cell_bits & 15u, number = cell_bits >> 4 & 0x1ffu;
            const float end = RAY_END(rays, first_packets[cell] + number / 16u, number % 16u);
            if (end == 0.0f) continue;
            const uint slot =
                DRAWN_SLOT(draws[DRAW_ROW(pass, group, draw, DRAW_ENTRY) + draw % 16u]);
            const uint old = own[16u * slot + cell];
            if ((old & 0xffffu) < MOST_TRIALS)
                own[16u * slot + cell] = old + (end > 0.0f ? 65537u : 1u);
        }
    }
}

// Rays of 16 cells.
typedef struct CellTrials {
    float16 traced, passed;
} CellTrials;

static CellTrials load_trials(uint16 counts) {
    CellTrials t;
    t.traced = convert_float16(counts & 0xffffu);
    t.passed = convert_float16(counts >> 16);
    return t;
}

// Sums over groups of 4 lanes, and over all, in every lane of the group.
static float16 sum_quarters(float16 v) {
    const float16 pairs = v + v.s1032547698badcfe;
    return pairs + pairs.s23016745ab89efcd;
}

static float16 sum_all(float16 quarters) {
    const float16 halves = quarters + quarters.s45670123cdef89ab;
    return halves + halves.s89abcdef01234567;
}

// A slot's trials in a whole tile: those of the cut (stage cuts) and of the cells. One slot per
// work-item.
KERNEL void visibility_sum(Tiles tiles, __global const uint* cut_sizes,
                           __global const Trials* probes, __global const uint16* counts,
                           uint light_count, __global Trials* totals) {
    const uint tile = get_global_id(0) / CUT_CAPACITY;
    const uint slot = get_global_id(0) % CUT_CAPACITY;
    if (tile >= tiles.count || slot >= cut_sizes[tile]) return;
    CellTrials sum = {(float16)(0.0f), (float16)(0.0f)};
    for (uint quadrant = 4u * tile; quadrant < 4u * tile + 4u; ++quadrant) {
        const CellTrials t =
            load_trials(counts[quadrant_slots(quadrant, light_count) / 16u + slot]);
        sum.traced += t.traced;
        sum.passed += t.passed;
    }
    Trials total = probes[tile * CUT_CAPACITY + slot];
    total.traced += sum_all(sum_quarters(sum.traced)).s0;
    total.passed += sum_all(sum_quarters(sum.passed)).s0;
    totals[tile * CUT_CAPACITY + slot] = total;
}

// Trials that neighbouring tiles lend a slot at most.
#define MOST_LENT 16.0f

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

// Slots that are neighbours in the tree's order share what is known of them.
#define GROUP 8u
// What a level of the tile's quadtree is worth to the next smaller one, rays.
#define PARENT_RAYS 8.0f
// V^ at least: what seems hidden is still drawn now and then.
#define LEAST_VISIBILITY 0.0005f

static float shrink(Trials trials, float towards, float rays) {
    return (trials.passed + rays * towards) / (trials.traced + rays);
}

static void add_trials(Trials* sum, Trials term) {
    sum->traced += term.traced;
    sum->passed += term.passed;
}

static float16 shrink_16(float16 traced, float16 passed, float16 towards) {
    return (passed + PARENT_RAYS * towards) * inverse_16(traced + PARENT_RAYS);
}

// The rays of a part of a tile to all slots, and how many of them were expected to pass.
typedef struct Outcome {
    float16 traced, passed, expected;
} Outcome;

static void add_outcome(Outcome* sum, float16 traced, float16 passed, float16 share) {
    sum->traced += traced;
    sum->passed += passed;
    sum->expected = fma(traced, share, sum->expected);
}

// What is taken for granted about a part of a tile: that it sees as much as expected, worth one ray
// that passed and one that did not.
#define SIGHT_RAYS 1.0f

// How the odds of all slots change by what the part of the tile sees more or less of them than was
// expected: lights are often hidden together.
typedef struct Odds {
    float16 passed, stopped;
} Odds;

static Odds odds_of(const Outcome* seen) {
    Odds odds;
    odds.passed = (seen->passed + SIGHT_RAYS) / (seen->expected + SIGHT_RAYS);
    odds.stopped =
        (seen->traced - seen->passed + SIGHT_RAYS) / (seen->traced - seen->expected + SIGHT_RAYS);
    return odds;
}

static float16 adjust(Odds odds, float16 share) {
    const float16 yes = share * odds.passed;
    return yes * inverse_16(fma(1.0f - share, odds.stopped, yes));
}

// visible[...] = V^ of every cell: from the tile's mean to the mean of GROUP slots, the slot, and
// then of 16 x 16, 8 x 8 and 4 x 4 pixels: each shrinks towards the one before, adjusted to what
// the part sees of all slots. Of tile_count tiles from first_tile on; visible[] holds these alone.
// One quadrant (16 x 16 pixels) per work-item.
KERNEL void visibility_estimate(uint first_tile, uint tile_count, __global const uint* cut_sizes,
                                __global const Trials* shared, __global const uint16* counts,
                                uint light_count, __global float16* visible) {
    const uint quadrant = get_global_id(0);
    if (quadrant >= 4u * tile_count) return;
    const uint tile = first_tile + quadrant / 4u;
    const uint size = cut_sizes[tile];
    __global const Trials* own = shared + tile * CUT_CAPACITY;
    __global const uint16* own_counts =
        counts + quadrant_slots(4u * first_tile + quadrant, light_count) / 16u;
    __global float16* own_visible = visible + quadrant_slots(quadrant, light_count) / 16u;
    const float16 zero = (float16)(0.0f);
    Trials all = {0.0f, 0.0f};
    for (uint slot = 0u; slot < size; ++slot) add_trials(&all, own[slot]);
    const float tile_share = shrink(all, PRIOR_SHARE, 1.0f);
    float group_share = 0.0f;
    Outcome of_16 = {zero, zero, zero}, of_8 = of_16, of_4 = of_16;
    for (uint slot = 0u; slot < size; ++slot) {
        if (slot % GROUP == 0u) {
            Trials group = {0.0f, 0.0f};
            for (uint i = slot; i < min(slot + GROUP, size); ++i) add_trials(&group, own[i]);
            group_share = shrink(group, tile_share, 1.0f);
        }
        const float16 share = (float16)(shrink(own[slot], group_share, 1.0f));
        const CellTrials t = load_trials(own_counts[slot]);
        add_outcome(&of_16, sum_all(sum_quarters(t.traced)), sum_all(sum_quarters(t.passed)),
                    share);
        own_visible[slot] = share;
    }
    Odds odds = odds_of(&of_16);
    for (uint slot = 0u; slot < size; ++slot) {
        const CellTrials t = load_trials(own_counts[slot]);
        const float16 traced = sum_quarters(t.traced), passed = sum_quarters(t.passed);
        const float16 share =
            shrink_16(sum_all(traced), sum_all(passed), adjust(odds, own_visible[slot]));
        add_outcome(&of_8, traced, passed, share);
        own_visible[slot] = share;
    }
    odds = odds_of(&of_8);
    for (uint slot = 0u; slot < size; ++slot) {
        const CellTrials t = load_trials(own_counts[slot]);
        const float16 share = shrink_16(sum_quarters(t.traced), sum_quarters(t.passed),
                                        adjust(odds, own_visible[slot]));
        add_outcome(&of_4, t.traced, t.passed, share);
        own_visible[slot] = share;
    }
    odds = odds_of(&of_4);
    for (uint slot = 0u; slot < size; ++slot) {
        const CellTrials t = load_trials(own_counts[slot]);
        const float16 share = shrink_16(t.traced, t.passed, adjust(odds, own_visible[slot]));
        own_visible[slot] = max(share, LEAST_VISIBILITY);
    }
}

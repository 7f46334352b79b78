// SPDX-License-Identifier: MIT
// Passes over the places of cells; see shared/adaptive.h.
#ifndef MANYLIGHT_LIB_CELLS_H
#define MANYLIGHT_LIB_CELLS_H

#include "lib/lanes.h"
#include "lib/tiles.h"
#include "shared/adaptive.h"

// Places of a cell (Morton codes) so that the first 1, 4, 8 and 16 are evenly spread.
__constant uchar place_order[16] = {12, 0, 4, 8, 3, 7, 11, 15, 1, 2, 5, 6, 9, 10, 13, 14};

// The item of pixel p of a pass.
static uint pass_item(Pass pass, uint p) {
    const uint place = p / 16u;
    const uint quadrant = 4u * pass.first_tile + place / pass.count;
    return 16u * (16u * quadrant + p % 16u) + place_order[pass.first + place % pass.count];
}

// The LANES pixels from LANES * group on are drawn together: the same place of as many cells.
static uint pass_groups(Pass pass) { return pass.tile_count * 4u * pass.count * (16u / LANES); }

// The cell of a group's first pixel, 0 to 15 in its quadrant, and that quadrant's number in the
// pass's run of tiles.
static uint group_cell(uint group) { return LANES * group % 16u; }
static uint group_quadrant(Pass pass, uint group) { return LANES * group / 16u / pass.count; }

// A drawn node: its slot and its index.
#define DRAWN_SLOT(entry) ((entry) >> 24)
#define DRAWN_NODE(entry) ((entry)&0x7fffffu)

// The end of a draw's ray where no ray was traced, since the drawn light contributes nothing to the
// pixel. Such a draw counts as an occluded ray in the node's visibility.
#define DARK -2.0f

// What the draws of a group hold, by rows of 16: draws[DRAW_ROW(...) + draw % 16]. The group's
// packets begin at group_packets().
#define DRAW_ENTRY 0u    // the drawn node
#define DRAW_LANE 1u     // lane; its how manieth draw << 4; which of `times` << 13; times << 22
#define DRAW_SHARE 2u    // float: the node's expected number of draws in the pixel
#define DRAW_CONTROL 3u  // float: this x the node's estimate is the control variate per draw
#define DRAW_ROW(pass, group, draw, row) \
    (64ul * (group_packets(pass, group) + (draw) / 16u) + 16u * (row))

static uint group_packets(Pass pass, uint group) { return LANES * pass.packets * group; }

// Where slot 0 of a quadrant begins in arrays over slots and cells; `quadrant` counts over tiles.
static ulong quadrant_slots(uint quadrant, uint light_count) {
    return 16ul * min(light_count, (uint)CUT_CAPACITY) * quadrant;
}

#endif

// SPDX-License-Identifier: MIT
// Passes over the places of cells; see shared/adaptive.h.
#ifndef MANYLIGHT_LIB_CELLS_H
#define MANYLIGHT_LIB_CELLS_H

#include "lib/tiles.h"
#include "shared/adaptive.h"

// Places of a cell (Morton codes) so that the first 1, 4, 8 and 16 are evenly spread.
__constant uchar place_order[16] = {12, 0, 4, 8, 3, 7, 11, 15, 1, 2, 5, 6, 9, 10, 13, 14};

// The item of pixel p of a pass.
static uint pass_item(Pass pass, uint p) {
    const uint cell = CELLS_PER_TILE * pass.first_tile + p / pass.count;
    return 16u * cell + place_order[pass.first + p % pass.count];
}

static uint pass_pixels(Pass pass) { return pass.tile_count * CELLS_PER_TILE * pass.count; }

// A drawn node: its slot, its index, and whether its ray is made (it is a single light).
#define DRAWN_SLOT(entry) ((entry) >> 24)
#define DRAWN_NODE(entry) ((entry)&0x7fffffu)
#define AIMED 0x800000u

// drawn[...] of a pixel that has no more draws.
#define NO_DRAW 0xffffffffu

// Where in drawn[] the draws of pixel p begin.
static uint first_draw(Pass pass, uint p) { return 16u * pass.packets * p; }

// Where slot 0 of a quadrant begins in arrays over slots and cells; `quadrant` counts over tiles.
static ulong quadrant_slots(uint quadrant) { return 16ul * CUT_CAPACITY * quadrant; }

#endif

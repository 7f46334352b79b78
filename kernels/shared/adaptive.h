// SPDX-License-Identifier: MIT
#ifndef MANYLIGHT_SHARED_ADAPTIVE_H
#define MANYLIGHT_SHARED_ADAPTIVE_H

#include "shared/types.h"

SHARED_BEGIN

/// Sampler adaptive works on tiles of 32 x 32 pixels. A tile has 4 quadrants of 16 x 16, a quadrant
/// 16 cells of 4 x 4, each in Morton order, so that item 1024 tile + 256 quadrant + 16 cell + place
/// is a pixel (shared/tiles.h). Kernels handle the same place of a quadrant's 16 cells in the 16
/// lanes of a vector.
#define ADAPTIVE_TILE 32
#define CELLS_PER_TILE 64

/// The nodes of a tile's cut are its slots 0 to CUT_CAPACITY - 1 at most; arrays over slots and
/// cells are [((4 tile + quadrant) * slots + slot) * 16 + cell], slots = min(lights, CUT_CAPACITY).
#define CUT_CAPACITY 256

/// What shadow rays said about a slot of a tile: how many were traced, and how many passed.
/// Children inherit part of their parent's, so these are no integers.
typedef struct Trials {
    float traced;
    float passed;
} Trials;
SHARED_SIZE(Trials, 8)

/// What a launch of a pass works on: in a run of tiles of the batch, the places order[first] to
/// order[first + count - 1] of every cell. Pixel p of the pass is in cell p % 16 of group p / 16;
/// group g is place first + g % count of quadrant 4 * first_tile + g / count of the batch. A pixel
/// has up to `packets` packets of 16 draws.
typedef struct Pass {
    uint first;
    uint count;
    uint number;  // of all passes over a pixel sample, for random numbers
    uint first_tile;
    uint tile_count;
    uint packets;
} Pass;
SHARED_SIZE(Pass, 24)

// The sampler's parameters. What each is worth, `scripts/parameters.sh` prints; none makes the
// estimate biased.

/// Shadow rays that a node of the cut is probed with, from up to REPRESENTATIVES pixels of the
/// tile; one in images so wide that tiles are small in them. What a node's children take over of
/// them.
#define PROBE_RAYS 4
#define REPRESENTATIVES 9
#define INHERITED 0.5f

/// The prior of a tile's visibility, the share of its shadow rays that pass; it weighs as much as
/// one ray.
#define PRIOR_SHARE 0.7f

/// Slots that are neighbours in the tree's order share what is known of them.
#define SLOT_GROUP 8
/// What a level of the tile's quadtree is worth to the next smaller one, rays.
#define PARENT_RAYS 8.0f
/// The prior of a part of a tile: as many rays pass as expected. It weighs as much as so many
/// passed and so many stopped rays.
#define SIGHT_RAYS 1.0f
/// Trials that neighbouring tiles lend a slot at most.
#define MOST_LENT 16.0f
/// V^ at least: what seems hidden is still drawn now and then.
#define LEAST_VISIBILITY 0.0005f

/// A node of less V^ is believed hidden, and one of which no ray has passed yet. Of a pixel's draws
/// such nodes get this share, at most: they may be bright enough to get all, and no ray can tell
/// that they never matter. They have no part in the control variate, where V^ of them would be a
/// guess. V^ of a node of which no ray has passed is stored with a minus sign.
#define SEEN_RAYS 0.5f
#define HIDDEN_VISIBILITY 0.01f
#define HIDDEN_SHARE 0.25f

/// Relative variance of the contribution of a light drawn from a node of several lights, divided by
/// its probability: the lights of a node differ.
#define GROUP_VARIANCE 0.5f
/// Relative variance of a pixel's whole estimate, by the errors of V^ and by the points on lights
/// with area.
#define PIXEL_VARIANCE 0.004f
/// A node is replaced by its children where its weight times its angular size exceeds this share of
/// the weight of one draw; so many are, at most.
#define REFINED_SHARE 0.25f
#define MOST_SPLITS 64

/// How many draws the pixels of a pass get.
typedef struct Budget {
    float samples;   // on average
    float factor;    // draws = deviation x this, within limits; 0: all pixels alike
    float exposure;  // times luminance: about 0.5 on average
} Budget;
SHARED_SIZE(Budget, 12)

/// The control variate of a node is CONTROL x V^ x its estimated contribution: it is added for all
/// nodes and subtracted from those drawn, so that shadow rays only correct it.
#define CONTROL 0.8f

/// A pixel's draws are between these, times the average.
#define FEWEST_DRAWS 0.25f
#define MOST_DRAWS 8.0f

/// Variance and expected value of a pixel's draws.
typedef struct Expectation {
    float variance;   // of the luminance, for one draw, (cd/m2)^2
    float luminance;  // cd/m2
} Expectation;
SHARED_SIZE(Expectation, 8)

SHARED_END

#endif

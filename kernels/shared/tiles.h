// SPDX-License-Identifier: MIT
#ifndef MANYLIGHT_SHARED_TILES_H
#define MANYLIGHT_SHARED_TILES_H

#include "shared/types.h"

SHARED_BEGIN

/// A run of tiles, in row order, of an image: what one launch of a per-pixel kernel works on.
///
/// Item i of such a launch is pixel (i % size^2) of tile first + i / size^2, where the pixels of a
/// tile are numbered along the Morton curve (x in the even bits). Items of tiles at the image's
/// right and lower edge may lie outside the image.
typedef struct Tiles {
    uint width;    // of the image, pixels
    uint height;   // of the image, pixels
    uint size;     // of a tile, pixels, a power of two
    uint columns;  // tiles in a row of the image
    uint first;    // first tile of the run
    uint count;    // tiles in the run
} Tiles;
SHARED_SIZE(Tiles, 24)

/// A square of a tile's quadtree: a cluster of pixels once it is a leaf.
typedef struct Region {
    uint x;              // left pixel
    uint y;              // top pixel
    uint size;           // pixels, a power of two; may reach beyond the image
    uint level;          // 0 for the whole tile
    uint first_sibling;  // index of the first of the siblings made by a visibility split,
    uint siblings;       // their number, or 0 if no visibility split made the region
} Region;
SHARED_SIZE(Region, 24)

/// The representative of a region in which no pixel hit the scene.
#define NO_ITEM 0xffffffffu

SHARED_END

#endif

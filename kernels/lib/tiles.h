// SPDX-License-Identifier: MIT
// Items of a launch to pixels and back; see shared/tiles.h.
#ifndef MANYLIGHT_LIB_TILES_H
#define MANYLIGHT_LIB_TILES_H

#include "lib/common.h"
#include "shared/tiles.h"

static uint even_bits(uint v) {
    v &= 0x55555555u;
    v = (v | (v >> 1)) & 0x33333333u;
    v = (v | (v >> 2)) & 0x0f0f0f0fu;
    v = (v | (v >> 4)) & 0x00ff00ffu;
    return (v | (v >> 8)) & 0x0000ffffu;
}

static uint spread_bits(uint v) {
    v = (v | (v << 8)) & 0x00ff00ffu;
    v = (v | (v << 4)) & 0x0f0f0f0fu;
    v = (v | (v << 2)) & 0x33333333u;
    return (v | (v << 1)) & 0x55555555u;
}

static uint2 item_pixel(Tiles tiles, uint item) {
    const uint area = tiles.size * tiles.size;
    const uint tile = tiles.first + item / area;
    const uint curve = item % area;
    return (uint2)(tile % tiles.columns, tile / tiles.columns) * tiles.size +
           (uint2)(even_bits(curve), even_bits(curve >> 1));
}

// The item of a pixel that lies in one of the run's tiles.
static uint pixel_item(Tiles tiles, uint x, uint y) {
    const uint tile = (y / tiles.size) * tiles.columns + x / tiles.size - tiles.first;
    return tile * tiles.size * tiles.size +
           (spread_bits(x % tiles.size) | (spread_bits(y % tiles.size) << 1));
}

// Whether this work-item's pixel exists; a launch is padded, and tiles reach beyond the image.
static bool item_in_image(Tiles tiles, uint item) {
    if (item >= tiles.count * tiles.size * tiles.size) return false;
    const uint2 pixel = item_pixel(tiles, item);
    return pixel.x < tiles.width && pixel.y < tiles.height;
}

#endif

// SPDX-License-Identifier: MIT
#pragma once

#include <glm/vec2.hpp>

#include "shared/tiles.h"

namespace manylight::reference {

/// The item of a pixel of a run of tiles; see shared/tiles.h.
[[nodiscard]] inline std::size_t item_of(const Tiles& tiles, uint x, uint y) {
    std::size_t curve = 0;
    for (uint bit = 0; (1u << bit) < tiles.size; ++bit) {
        curve |= std::size_t{x % tiles.size >> bit & 1} << (2 * bit);
        curve |= std::size_t{y % tiles.size >> bit & 1} << (2 * bit + 1);
    }
    const std::size_t tile = y / tiles.size * tiles.columns + x / tiles.size - tiles.first;
    return tile * tiles.size * tiles.size + curve;
}

/// Calls visit(x, y, item) for every pixel of a run of tiles that is in the image.
template <class Visit>
void for_each_pixel(const Tiles& tiles, Visit&& visit) {
    for (uint tile = tiles.first; tile < tiles.first + tiles.count; ++tile)
        for (uint y = tile / tiles.columns * tiles.size, y0 = y;
             y < y0 + tiles.size && y < tiles.height; ++y)
            for (uint x = tile % tiles.columns * tiles.size, x0 = x;
                 x < x0 + tiles.size && x < tiles.width; ++x)
                visit(x, y, item_of(tiles, x, y));
}

}  // namespace manylight::reference

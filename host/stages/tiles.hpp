// SPDX-License-Identifier: MIT
#pragma once

#include <glm/vec2.hpp>
#include <vector>

#include "shared/tiles.h"

namespace manylight {

/// All tiles of an image; `size` is a power of two.
[[nodiscard]] inline Tiles all_tiles(unsigned width, unsigned height, unsigned size) {
    const unsigned columns = (width + size - 1) / size;
    return {width, height, size, columns, 0, columns * ((height + size - 1) / size)};
}

/// Those in the image's middle, `most` of them at most.
[[nodiscard]] inline Tiles middle_tiles(unsigned width, unsigned height, unsigned size,
                                        unsigned most) {
    Tiles tiles = all_tiles(width, height, size);
    if (tiles.count <= most) return tiles;
    tiles.first = (tiles.count - most) / 2;
    tiles.count = most;
    return tiles;
}

/// Work-items of a launch over a run of tiles.
[[nodiscard]] inline std::size_t item_count(const Tiles& tiles) {
    return std::size_t{tiles.count} * tiles.size * tiles.size;
}

/// The pixel of an item, which may lie outside the image; see shared/tiles.h.
[[nodiscard]] inline glm::uvec2 item_pixel(const Tiles& tiles, std::size_t item) {
    const std::size_t area = std::size_t{tiles.size} * tiles.size;
    const auto tile = static_cast<unsigned>(tiles.first + item / area);
    glm::uvec2 pixel{tile % tiles.columns * tiles.size, tile / tiles.columns * tiles.size};
    for (unsigned bit = 0; bit < 16; ++bit) {
        pixel.x += (item % area >> (2 * bit) & 1) << bit;
        pixel.y += (item % area >> (2 * bit + 1) & 1) << bit;
    }
    return pixel;
}

/// Pixels of a run of tiles that lie in the image.
[[nodiscard]] std::size_t pixel_count(const Tiles& tiles);

/// The root regions of a run of tiles.
[[nodiscard]] std::vector<Region> root_regions(const Tiles& tiles);

/// The quarters of a region that reach into the image.
[[nodiscard]] std::vector<Region> quarters(const Region& region, const Tiles& tiles);

}  // namespace manylight

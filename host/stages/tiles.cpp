// SPDX-License-Identifier: MIT
#include "stages/tiles.hpp"

#include <algorithm>

namespace manylight {

std::size_t pixel_count(const Tiles& tiles) {
    std::size_t pixels = 0;
    for (const Region& root : root_regions(tiles))
        pixels += std::size_t{std::min(root.x + root.size, tiles.width) - root.x} *
                  (std::min(root.y + root.size, tiles.height) - root.y);
    return pixels;
}

std::vector<Region> root_regions(const Tiles& tiles) {
    std::vector<Region> regions;
    for (uint tile = tiles.first; tile < tiles.first + tiles.count; ++tile)
        regions.push_back({tile % tiles.columns * tiles.size, tile / tiles.columns * tiles.size,
                           tiles.size, 0, 0, 0});
    return regions;
}

std::vector<Region> quarters(const Region& region, const Tiles& tiles) {
    std::vector<Region> out;
    const uint half = region.size / 2;
    for (uint i = 0; i < 4; ++i) {
        const uint x = region.x + i % 2 * half;
        const uint y = region.y + i / 2 * half;
        if (x < tiles.width && y < tiles.height)
            out.push_back({x, y, half, region.level + 1, 0, 0});
    }
    return out;
}

}  // namespace manylight

// SPDX-License-Identifier: MIT
#include "reference/representatives.hpp"

#include <algorithm>

#include "reference/tiles.hpp"

namespace manylight::reference {

uint representative(const Tiles& tiles, std::span<const Surface> surfaces, const Region& region) {
    const uint end_x = std::min(region.x + region.size, tiles.width);
    const uint end_y = std::min(region.y + region.size, tiles.height);
    const int centre_x = static_cast<int>(std::min(region.x + region.size / 2, end_x - 1));
    const int centre_y = static_cast<int>(std::min(region.y + region.size / 2, end_y - 1));
    uint best = NO_ITEM;
    int best_distance = std::numeric_limits<int>::max();
    for (uint y = region.y; y < end_y; ++y)
        for (uint x = region.x; x < end_x; ++x) {
            const std::size_t item = item_of(tiles, x, y);
            const int dx = static_cast<int>(x) - centre_x;
            const int dy = static_cast<int>(y) - centre_y;
            if (surfaces[item].position.w < 0 || dx * dx + dy * dy >= best_distance) continue;
            best = static_cast<uint>(item);
            best_distance = dx * dx + dy * dy;
        }
    return best;
}

}  // namespace manylight::reference

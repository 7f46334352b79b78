// SPDX-License-Identifier: MIT
#include "reference/clusters.hpp"

#include <algorithm>

#include "reference/tiles.hpp"

namespace manylight::reference {
namespace {

// In single precision, term by term: the decision is defined by these operations.
bool differ(const Surface& a, const Surface& b, float cos_threshold) {
    const bool a_hit = a.position.w >= 0;
    const bool b_hit = b.position.w >= 0;
    if (!a_hit && !b_hit) return false;
    if (a_hit != b_hit) return true;
    float cosine = a.normal.x * b.normal.x;
    cosine += a.normal.y * b.normal.y;
    cosine += a.normal.z * b.normal.z;
    return cosine < cos_threshold;
}

bool contains(const Region& region, uint x, uint y) {
    return x >= region.x && x < region.x + region.size && y >= region.y &&
           y < region.y + region.size;
}

}  // namespace

std::vector<uint> split_by_normals(const Tiles& tiles, std::span<const Surface> surfaces,
                                   std::span<const Region> regions, float cos_threshold,
                                   uint max_level) {
    std::vector<uint> split;
    for (const Region& r : regions) {
        std::vector<const Surface*> corners;
        for (const uint y : {r.y, std::min(r.y + r.size, tiles.height) - 1})
            for (const uint x : {r.x, std::min(r.x + r.size, tiles.width) - 1})
                corners.push_back(&surfaces[item_of(tiles, x, y)]);
        bool any = false;
        for (const Surface* a : corners)
            for (const Surface* b : corners) any = any || differ(*a, *b, cos_threshold);
        split.push_back(any && r.level < max_level && r.size > 1 ? 1 : 0);
    }
    return split;
}

std::vector<uint> assign_rows(const Tiles& tiles, std::span<const Region> regions,
                              std::span<const uint> split) {
    std::vector<uint> rows(std::size_t{tiles.count} * tiles.size * tiles.size, ~0u);
    for (std::size_t r = 0; r < regions.size(); ++r) {
        if (split[r]) continue;
        for_each_pixel(tiles, [&](uint x, uint y, std::size_t item) {
            if (contains(regions[r], x, y)) rows[item] = static_cast<uint>(r);
        });
    }
    return rows;
}

}  // namespace manylight::reference

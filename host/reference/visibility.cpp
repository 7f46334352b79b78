// SPDX-License-Identifier: MIT
#include "reference/visibility.hpp"

#include <algorithm>

#include "shared/adaptive.h"

namespace manylight::reference {

std::vector<Rays> share_rays(const LightTree& tree, const Tiles& tiles, uint tile,
                             std::span<const TileRays> all) {
    std::vector<Rays> out = all[tile].totals;
    const int x = static_cast<int>((tiles.first + tile) % tiles.columns);
    const int y = static_cast<int>((tiles.first + tile) / tiles.columns);
    for (std::size_t slot = 0; slot < out.size(); ++slot) {
        const LightNode& node = tree.nodes[all[tile].nodes[slot]];
        Rays lent;
        for (const glm::ivec2 step : {glm::ivec2(1, 0), {-1, 0}, {0, 1}, {0, -1}}) {
            if (x + step.x < 0 || x + step.x >= static_cast<int>(tiles.columns)) continue;
            const int other = (y + step.y) * static_cast<int>(tiles.columns) + x + step.x -
                              static_cast<int>(tiles.first);
            if (other < 0 || other >= static_cast<int>(all.size())) continue;
            for (std::size_t i = 0; i < all[other].nodes.size(); ++i) {
                const LightNode& theirs = tree.nodes[all[other].nodes[i]];
                const int common = static_cast<int>(std::min(node.first + node.count,
                                                             theirs.first + theirs.count)) -
                                   static_cast<int>(std::max(node.first, theirs.first));
                if (common <= 0) continue;
                const double share = static_cast<double>(common) / theirs.count;
                lent.traced += share * all[other].totals[i].traced;
                lent.passed += share * all[other].totals[i].passed;
            }
        }
        const double scale = lent.traced > MOST_LENT ? MOST_LENT / lent.traced : 1;
        out[slot].traced += scale * lent.traced;
        out[slot].passed += scale * lent.passed;
    }
    return out;
}

std::vector<double> estimate_visibility(std::span<const Rays> totals,
                                        std::span<const Rays> counts) {
    const std::size_t size = totals.size();
    const auto add = [](Rays& sum, const Rays& r) {
        sum.traced += r.traced;
        sum.passed += r.passed;
    };
    const auto shrunk = [](const Rays& r, double towards, double weight) {
        return (r.passed + weight * towards) / (r.traced + weight);
    };
    Rays all;
    for (const Rays& total : totals) add(all, total);
    std::vector<double> visible(64 * size);
    for (std::size_t slot = 0; slot < size; ++slot) {
        Rays group;
        const std::size_t first = slot / SLOT_GROUP * SLOT_GROUP;
        for (std::size_t i = first; i < std::min(first + SLOT_GROUP, size); ++i)
            add(group, totals[i]);
        const double of_slot =
            shrunk(totals[slot], shrunk(group, shrunk(all, PRIOR_SHARE, 1), 1), 1);
        for (std::size_t cell = 0; cell < 64; ++cell) visible[64 * slot + cell] = of_slot;
    }
    // Parts of the tile, smaller and smaller, of so many cells.
    for (const std::size_t cells : {16, 4, 1}) {
        for (std::size_t part = 0; part < 64; part += cells) {
            std::vector<Rays> rays(size);
            Rays seen;
            double expected = 0;  // to pass, of those traced
            for (std::size_t slot = 0; slot < size; ++slot) {
                for (std::size_t cell = part; cell < part + cells; ++cell)
                    add(rays[slot], counts[64 * slot + cell]);
                add(seen, rays[slot]);
                expected += rays[slot].traced * visible[64 * slot + part];
            }
            const double passed = (seen.passed + SIGHT_RAYS) / (expected + SIGHT_RAYS);
            const double stopped =
                (seen.traced - seen.passed + SIGHT_RAYS) / (seen.traced - expected + SIGHT_RAYS);
            for (std::size_t slot = 0; slot < size; ++slot) {
                const double share = visible[64 * slot + part];
                const double odds = share * passed / ((1 - share) * stopped);
                const double result = shrunk(rays[slot], odds / (1 + odds), PARENT_RAYS);
                for (std::size_t cell = part; cell < part + cells; ++cell)
                    visible[64 * slot + cell] = result;
            }
        }
    }
    for (std::size_t i = 0; i < visible.size(); ++i) {
        visible[i] = std::max(visible[i], double{LEAST_VISIBILITY});
        if (totals[i / 64].passed < double{SEEN_RAYS}) visible[i] = -visible[i];
    }
    return visible;
}

}  // namespace manylight::reference

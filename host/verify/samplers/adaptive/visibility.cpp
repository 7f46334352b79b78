// SPDX-License-Identifier: MIT
#include "reference/visibility.hpp"

#include <cmath>

#include "verify/samplers/adaptive/run.hpp"
#include "verify/tolerances.hpp"

namespace manylight::adaptive_stages {

namespace {

// What the cells of a tile counted in the first pass, [64 * slot + cell].
std::vector<reference::Rays> count_rays(const Run& run, uint tile) {
    std::vector<reference::Rays> counts(64 * std::size_t{run.sizes[tile]});
    const std::size_t pixels = std::size_t{64} * run.first.count;
    for (std::size_t p = tile * pixels; p < (tile + 1) * pixels; ++p)
        for (const DrawnNode& draw : run.first_drawn[p]) {
            if (draw.end == 0) continue;
            const std::size_t cell = Run::item(run.first, p) / 16 % 64;
            reference::Rays& count = counts[64 * draw.slot + cell];
            count.traced += 1;
            count.passed += draw.end > 0 ? 1 : 0;
        }
    return counts;
}

}  // namespace

Check check_visibility(const Run& run, const LightTree& tree) {
    Check check{.stage = "visibility",
                .tolerance = "32 eps (10 operations per level) + eps / 16 per ray of the tile"};
    std::vector<std::vector<reference::Rays>> counts;
    std::vector<reference::TileRays> tiles;
    for (uint tile = 0; tile < run.tiles.count; ++tile) {
        counts.push_back(count_rays(run, tile));
        reference::TileRays& rays = tiles.emplace_back();
        for (uint slot = 0; slot < run.sizes[tile]; ++slot) {
            const std::size_t place = tile * CUT_CAPACITY + slot;
            rays.nodes.push_back(run.nodes[place]);
            reference::Rays& total = rays.totals.emplace_back(
                reference::Rays{run.probes[place].traced, run.probes[place].passed});
            for (uint cell = 0; cell < 64; ++cell) {
                total.traced += counts[tile][64 * slot + cell].traced;
                total.passed += counts[tile][64 * slot + cell].passed;
            }
        }
    }
    for (uint tile = 0; tile < run.tiles.count; ++tile) {
        const std::vector<double> visible = reference::estimate_visibility(
            reference::share_rays(tree, run.tiles, tile, tiles), counts[tile]);
        // How many were expected to pass is a sum over all, and small differences of it count.
        double rays = 0;
        for (const reference::Rays& count : counts[tile]) rays += count.traced;
        for (uint slot = 0; slot < run.sizes[tile]; ++slot)
            for (uint cell = 0; cell < 64; ++cell) {
                const reference::Rays& expected = counts[tile][64 * slot + cell];
                const uint found = run.counts[run.place(tile, slot, cell)];
                const std::string name = fmt::format("tile {}, slot {}, cell {}", tile, slot, cell);
                check.compare_exact(
                    (found & 0xffff) == expected.traced && found >> 16 == expected.passed,
                    name + ": rays");
                const double v = visible[64 * slot + cell];
                check.compare(std::abs(run.visible[run.place(tile, slot, cell)] - v),
                              (64 + rays / 8) * epsilon * std::abs(v), name);
            }
    }
    return check;
}

}  // namespace manylight::adaptive_stages

// SPDX-License-Identifier: MIT
// Which cells of area lights points of emissive triangles are on, as stage reflections finds them.
#include <cmath>

#include "reference/random.hpp"
#include "reference/reflections.hpp"
#include "reference/triangle.hpp"
#include "verify/stages.hpp"
#include "verify/tolerances.hpp"

namespace manylight {
namespace {

Check cells(Verifier& verifier) {
    Check check{.stage = "cells",
                .tolerance =
                    "16 eps of the shape + 8 eps of the coordinates + 1e-4 of its sides, by "
                    "which joined triangles may be off"};
    const LightCells& cells = verifier.scene().light_cells;
    if (cells.empty()) return check;
    constexpr uint points = 64;  // of a triangle
    std::vector<CellGrid> grids;
    std::vector<uint> triangles;
    for (uint i = 0;
         i < cells.grid_of.size() && grids.size() < verifier.options().most_entries / points; ++i)
        if (cells.grid_of[i] != NO_GRID) {
            grids.push_back(cells.grids[cells.grid_of[i]]);
            triangles.push_back(i);
        }
    std::vector<glm::vec2> weights(points * grids.size());
    for (uint i = 0; i < weights.size(); ++i) {
        const glm::dvec2 w = reference::pixel_position(i, 0, verifier.options().seed);
        weights[i] = glm::vec2(w.x + w.y > 1 ? 1.0 - w : w);
    }
    Buffer<uint> numbers = verifier.device().allocate<uint>(weights.size());
    verifier.device()
        .kernel("probe.cl", "probe_cells", {}, "probe")
        .launch(weights.size(), Arguments()
                                    .set("count", static_cast<uint>(weights.size()))
                                    .set("grids", verifier.device().upload(grids))
                                    .set("weights", verifier.device().upload(weights))
                                    .set("cells", numbers));
    const std::vector<uint> found = numbers.download();
    for (uint i = 0; i < weights.size(); ++i) {
        const CellGrid& grid = grids[i / points];
        const reference::Triangle triangle(verifier.scene(), triangles[i / points]);
        const glm::dvec3 point = triangle.corner(0) +
                                 double{weights[i].x} * (triangle.corner(1) - triangle.corner(0)) +
                                 double{weights[i].y} * (triangle.corner(2) - triangle.corner(0));
        const std::string where = fmt::format("triangle {} at ({}, {})", triangles[i / points],
                                              weights[i].x, weights[i].y);
        const bool exists = found[i] < grid.columns * grid.rows;
        check.compare_exact(exists, fmt::format("{}: no cell {}", where, found[i]));
        if (!exists) continue;
        double longest = 0;
        for (int k = 0; k < 3; ++k)
            longest =
                std::max(longest, glm::distance(triangle.corner(k), triangle.corner((k + 1) % 3)));
        const double height = glm::length(triangle.face()) / longest;
        const double tolerance = std::max(grid.columns, grid.rows) *
                                 (1e-4 + 16 * epsilon + 8 * epsilon * glm::length(point) / height);
        const uint light = cells.lights[grid.first + found[i]];
        const reference::CellAt expected =
            reference::cell_at(verifier.scene(), triangles[i / points], point);
        // Without a light: no light's cell holds it.
        double outside = expected.light == NO_LIGHT ? 0 : expected.margin;
        if (light != NO_LIGHT)
            outside = std::max(-reference::inside(verifier.lights()[light], point), 0.0);
        check.compare(
            outside, tolerance,
            fmt::format("{}: cell {} is not light {}'s", where, found[i], expected.light));
    }
    return check;
}

}  // namespace

StageCheck check_cells() { return {.stages = {"cells"}, .run = single<cells>}; }

}  // namespace manylight

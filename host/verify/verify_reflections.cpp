// SPDX-License-Identifier: MIT
// Stage reflections, and which cells its rays meet.
#include <cmath>

#include "reference/random.hpp"
#include "reference/reflections.hpp"
#include "reference/tiles.hpp"
#include "reference/triangle.hpp"
#include "stages/reflections.hpp"
#include "verify/sampler_checks.hpp"
#include "verify/tolerances.hpp"
#include "verify/verify.hpp"

namespace manylight {

Check Verifier::cells() {
    Check check{.stage = "cells",
                .tolerance =
                    "16 eps of the shape + 8 eps of the coordinates + 1e-4 of its sides, by "
                    "which joined triangles may be off"};
    const LightCells& cells = scene_.light_cells;
    if (cells.empty()) return check;
    constexpr uint points = 64;  // of a triangle
    std::vector<CellGrid> grids;
    std::vector<uint> triangles;
    for (uint i = 0; i < cells.grid_of.size() && grids.size() < options_.most_entries / points; ++i)
        if (cells.grid_of[i] != NO_GRID) {
            grids.push_back(cells.grids[cells.grid_of[i]]);
            triangles.push_back(i);
        }
    std::vector<glm::vec2> weights(points * grids.size());
    for (uint i = 0; i < weights.size(); ++i) {
        const glm::dvec2 w = reference::pixel_position(i, 0, options_.seed);
        weights[i] = glm::vec2(w.x + w.y > 1 ? 1.0 - w : w);
    }
    Buffer<uint> numbers = device_.allocate<uint>(weights.size());
    device_.kernel("probe.cl", "probe_cells", {}, "probe")
        .launch(weights.size(), Arguments()
                                    .set("count", static_cast<uint>(weights.size()))
                                    .set("grids", device_.upload(grids))
                                    .set("weights", device_.upload(weights))
                                    .set("cells", numbers));
    const std::vector<uint> found = numbers.download();
    for (uint i = 0; i < weights.size(); ++i) {
        const CellGrid& grid = grids[i / points];
        const reference::Triangle triangle(scene_, triangles[i / points]);
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
        const reference::CellAt expected = reference::cell_at(scene_, triangles[i / points], point);
        // Without a light: no light's cell holds it.
        double outside = expected.light == NO_LIGHT ? 0 : expected.margin;
        if (light != NO_LIGHT)
            outside = std::max(-reference::inside(scene_.lights[light], point), 0.0);
        check.compare(
            outside, tolerance,
            fmt::format("{}: cell {} is not light {}'s", where, found[i], expected.light));
    }
    return check;
}

// With as many light samples as take several rounds of all samplers.
Check Verifier::reflections(const Sampler* sampler) {
    Check check{.stage = sampler ? fmt::format("reflections ({})", sampler->name) : "reflections",
                .tolerance = "64 eps (40 operations) + change under 16 eps shifts of the ray"};
    if (device_scene_.shading.at("HAS_REFLECTIONS") == 0) return check;
    const PixelSample sample{2, options_.seed, false};
    const uint light_samples = 40;
    // On top of other light: what is there stays.
    const float there = 0x1p-10f;
    Buffer<float4> estimates =
        device_.upload(std::vector<float4>(item_count(tiles_), float4(there)));
    send_out(found_);
    std::unique_ptr<LightSampler> drawing;
    std::unique_ptr<reference::Sampler> judge_sampler;
    const reference::OneLight* one_light = nullptr;
    if (sampler) {
        drawing = sampler->make({device_, device_scene(*sampler), scene_.lights, tiles_.count,
                                 tiles_.size, options_.width, light_samples, options_.clusters,
                                 values_of(*sampler)});
        drawing->prepare();
        drawing->begin(tiles_, surfaces_, options_.seed, [](std::size_t) {});
        judge_sampler = checks_of(*sampler).reference(*drawing, {scene_, tree_});
        one_light = dynamic_cast<const reference::OneLight*>(judge_sampler.get());
    }
    ReflectionStage(device_, sampler ? device_scene(*sampler) : device_scene_, item_count(tiles_),
                    sampler ? sampler->closed_form : "")
        .add(tiles_, sample, light_samples, surfaces_, sampler ? drawing->tables() : Arguments(),
             estimates);
    const std::vector<float4> found = estimates.download();
    reference::for_each_pixel(tiles_, [&](uint x, uint y, std::size_t item) {
        reference::CountOf count_of;
        if (one_light)
            count_of = [&](uint light) {
                return *one_light->expected_count({scene_, view_.of(item), found_[item]}, item,
                                                  light, light_samples);
            };
        const auto judge = [&](bool closely) {
            return reference::reflection(scene_, tracer_, view_.of(item), found_[item],
                                         y * tiles_.width + x, sample.index, sample.seed, closely,
                                         count_of);
        };
        reference::Reflection expected = judge(false);
        const auto difference = [&] {
            return glm::length(glm::dvec4(found[item]) - glm::dvec4(expected.value, 0) -
                               double{there});
        };
        double tolerance =
            shading_roundings * epsilon * (glm::length(expected.value) + double{there});
        if (difference() > tolerance / 4) {
            expected = judge(true);
            tolerance += expected.slack;
            if (difference() > tolerance && expected.borderline) return check.skip_borderline();
        }
        check.compare(
            difference(), tolerance,
            fmt::format("pixel ({}, {}): {} is not {}", x, y,
                        show(glm::dvec3(found[item]) - glm::dvec3(there)), show(expected.value)),
            found[item].r == there && expected.value.r == 0);
    });
    return check;
}

std::vector<Check> Verifier::all_reflections() {
    std::vector<Check> checks = {reflections()};
    for (const Sampler& sampler : all_samplers())
        if (!sampler.closed_form.empty()) checks.push_back(reflections(&sampler));
    return checks;
}

}  // namespace manylight

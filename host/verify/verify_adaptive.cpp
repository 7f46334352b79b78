// SPDX-License-Identifier: MIT
// The stages of sampler adaptive: cuts, visibility, weights (the draw of nodes), samples.
#include <algorithm>
#include <cmath>

#include "reference/adaptive.hpp"
#include "reference/contributions.hpp"
#include "reference/cuts.hpp"
#include "reference/random.hpp"
#include "reference/tiles.hpp"
#include "reference/visibility.hpp"
#include "samplers/adaptive/adaptive_samples.hpp"
#include "verify/tolerances.hpp"
#include "verify/verify.hpp"

namespace manylight {
namespace {

using reference::Viewers;

constexpr uint most_tiles = 9;
constexpr double darkest = 1e-9;  // cd/m2: a light just below the horizon
constexpr const char* node_tolerance = "1e-3 (some 100 operations, lobes narrower than 1e-3 rad)";

const uint place_order[16] = {12, 0, 4, 8, 3, 7, 11, 15, 1, 2, 5, 6, 9, 10, 13, 14};

// Two passes over some tiles, the second of which has learned from the first.
struct Run {
    unsigned lanes;  // pixels that are drawn together
    Tiles tiles;
    Pass first{0, 8, 0, 0, 0, 2}, second{8, 8, 0, 0, 0, 2};
    Budget budget{4, 4, 1};
    PixelSample sample;
    std::vector<Surface> surfaces;
    std::vector<uint> nodes, sizes;  // the cuts'
    std::vector<Trials> probes;
    std::vector<std::vector<DrawnNode>> first_drawn, drawn;  // [pixel of the pass]
    std::size_t slots = 0;                                   // of a tile in what follows
    std::vector<uint> counts;                                // after the first pass
    std::vector<float> visible;                              // likewise
    std::vector<float4> estimates;

    Run(Device& device, const DeviceScene& scene, Tiles all, uint cut_size, uint seed,
        std::size_t first_point, const std::function<void(const std::vector<Surface>&)>& ready)
        : lanes(device.form().pixels), tiles(all), sample{3, seed, false} {
        tiles.count = std::min(tiles.count, most_tiles);
        first.tile_count = second.tile_count = tiles.count;
        Buffer<Surface> points = device.allocate<Surface>(item_count(tiles));
        GBufferStage(device, scene).trace(tiles, {}, points, first_point);
        surfaces = points.download();
        ready(surfaces);
        Cuts cuts(device, tiles.count);
        CutStage(device, scene).make(tiles, points, {cut_size, PROBE_RAYS, seed}, cuts);
        nodes = cuts.nodes.download();
        sizes = cuts.sizes.download();
        probes = cuts.probes.download();
        slots = Visibility::slots(scene.light_count);
        Visibility visibility(device, scene.light_count, tiles.count, tiles.count);
        VisibilityStage learn(device, scene);
        visibility.counts.clear();
        learn.sum(tiles, cuts, visibility);
        learn.estimate(0, tiles.count, cuts, visibility);
        AdaptiveStage stage(device, scene, pass_pixels(first) * first.packets, pass_pixels(first));
        Estimates sums{device.allocate<float4>(item_count(tiles)), {}};
        stage.draw(tiles, first, {budget.samples, 0, 0}, sample, points, cuts, visibility, 1, true,
                   sums);
        first_drawn = stage.drawn(first);
        learn.learn(first, stage.draws(), visibility);
        learn.sum(tiles, cuts, visibility);
        learn.estimate(0, tiles.count, cuts, visibility);
        counts = visibility.counts.download();
        visible = visibility.visible.download();
        stage.draw(tiles, second, budget, sample, points, cuts, visibility, 1, true, sums);
        drawn = stage.drawn(second);
        estimates = sums.sums.download();
    }

    // Where a slot's cell is in counts and visible.
    [[nodiscard]] std::size_t place(std::size_t tile, std::size_t slot, std::size_t cell) const {
        return ((4 * tile + cell / 16) * slots + slot) * 16 + cell % 16;
    }
    // The item of a pixel of a pass.
    [[nodiscard]] static std::size_t item(const Pass& pass, std::size_t pixel) {
        const std::size_t place = pixel / 16;
        return 16 * (16 * (place / pass.count) + pixel % 16) +
               place_order[pass.first + place % pass.count];
    }
    [[nodiscard]] bool hit(std::size_t item) const {
        const glm::uvec2 at = item_pixel(tiles, item);
        return at.x < tiles.width && at.y < tiles.height && surfaces[item].position.w >= 0;
    }
};

Check check_cuts(const Run& run, const LightTree& tree, const Scene& scene,
                 const reference::Tracer& tracer, const Viewers& view, uint cut_size) {
    Check check{.stage = "cuts", .tolerance = "none, but for close calls"};
    for (uint tile = 0; tile < run.tiles.count; ++tile) {
        const reference::TileCut expected =
            reference::make_cut(tree, scene, tracer, view, run.tiles, tile, run.surfaces, cut_size,
                                PROBE_RAYS, run.sample.seed);
        // Whatever rounding does: every light is in one node, in order.
        uint next = 0;
        for (uint slot = 0; slot < run.sizes[tile]; ++slot) {
            const LightNode& node = tree.nodes[run.nodes[tile * CUT_CAPACITY + slot]];
            check.compare_exact(node.first == next, fmt::format("tile {}, slot {}", tile, slot));
            next = node.first + node.count;
        }
        check.compare_exact(next == tree.lights.size(),
                            fmt::format("tile {}: {} lights", tile, next));
        if (expected.uncertain) continue;
        check.compare_exact(
            run.sizes[tile] == expected.nodes.size(),
            fmt::format("tile {}: {} nodes, not {}", tile, run.sizes[tile], expected.nodes.size()));
        for (uint slot = 0; slot < std::min<std::size_t>(run.sizes[tile], expected.nodes.size());
             ++slot) {
            const std::size_t place = tile * CUT_CAPACITY + slot;
            check.compare_exact(run.nodes[place] == expected.nodes[slot],
                                fmt::format("tile {}, slot {}: node {}, not {}", tile, slot,
                                            run.nodes[place], expected.nodes[slot]));
            check.compare(std::abs(run.probes[place].passed - expected.probes[slot].passed) +
                              std::abs(run.probes[place].traced - expected.probes[slot].traced),
                          1e-4, fmt::format("tile {}, slot {}: probes", tile, slot));
        }
    }
    return check;
}

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

// The pixels that are drawn together with pixel p of the second pass; `starts`: where their draws
// start, which matters to which nodes are drawn alone.
std::vector<reference::DrawnPixel> group_of(const Run& run, const Viewers& view, std::size_t p,
                                            bool starts) {
    std::vector<reference::DrawnPixel> pixels;
    for (std::size_t lane = 0; lane < run.lanes; ++lane) {
        const std::size_t item = Run::item(run.second, p / run.lanes * run.lanes + lane);
        const std::size_t tile = item / (std::size_t{ADAPTIVE_TILE} * ADAPTIVE_TILE);
        const glm::uvec2 at = item_pixel(run.tiles, item);
        reference::DrawnPixel& pixel = pixels.emplace_back(reference::DrawnPixel{
            run.hit(item) ? &run.surfaces[item] : nullptr,
            view.of(item),
            starts
                ? reference::draw_starts(at.x, at.y, run.second, run.sample.index, run.sample.seed)
                : reference::Starts{0.5, 0.5},
            {}});
        for (uint slot = 0; slot < run.sizes[tile]; ++slot)
            pixel.visible.push_back(run.visible[run.place(tile, slot, item / 16 % 64)]);
    }
    return pixels;
}

// Whether a pixel's draws are those expected.
bool agree(const std::vector<DrawnNode>& found, const auto& expected) {
    return std::ranges::equal(found, expected, [](const DrawnNode& a, const auto& b) {
        return a.slot == b.slot && a.node == b.node &&
               std::abs(a.share - b.share) <= 1e-3 * b.share;
    });
}

// The draws of the second pass, a group of pixels at a time.
Check check_weights(const Run& run, const LightTree& tree, const Scene& scene, const Viewers& view,
                    std::size_t most_entries) {
    Check check{.stage = "weights", .tolerance = node_tolerance};
    const std::size_t groups = pass_pixels(run.second) / run.lanes;
    const std::size_t stride =
        (groups * run.lanes * std::max<std::size_t>(run.sizes.empty() ? 1 : run.sizes[0], 16) /
         most_entries) |
        1;
    for (std::size_t group = 0; group < groups; group += stride) {
        const std::size_t tile =
            Run::item(run.second, run.lanes * group) / (std::size_t{ADAPTIVE_TILE} * ADAPTIVE_TILE);
        const std::vector<reference::DrawnPixel> pixels =
            group_of(run, view, run.lanes * group, true);
        const std::vector<reference::NodeDraws> expected = reference::draw_nodes(
            tree, scene, std::span(run.nodes).subspan(tile * CUT_CAPACITY, run.sizes[tile]), pixels,
            run.budget);
        for (std::size_t lane = 0; lane < run.lanes; ++lane) {
            if (expected[lane].uncertain &&
                !agree(run.drawn[run.lanes * group + lane], expected[lane].draws)) {
                check.excuse(1);
                check.skip_borderline();
                continue;
            }
            const std::string name = fmt::format("pixel {} of the pass", run.lanes * group + lane);
            const auto& draws = expected[lane].draws;
            const std::vector<DrawnNode>& found = run.drawn[run.lanes * group + lane];
            const std::size_t count = found.size();
            check.compare_exact(count == draws.size(),
                                fmt::format("{}: {} draws, not {}", name, count, draws.size()));
            for (std::size_t i = 0; i < std::min(count, draws.size()); ++i) {
                check.compare_exact(
                    found[i].slot == draws[i].slot && found[i].node == draws[i].node,
                    fmt::format("{}, draw {}: node {}, not {}", name, i, found[i].node,
                                draws[i].node));
                check.compare(std::abs(found[i].share - draws[i].share), 1e-3 * draws[i].share,
                              fmt::format("{}, draw {}: share {}, not {}", name, i, found[i].share,
                                          draws[i].share));
            }
        }
    }
    return check;
}

// The estimates of the second pass, from what it drew.
Check check_samples(const Run& run, const LightTree& tree, const Scene& scene,
                    const reference::Tracer& tracer, const Viewers& view,
                    std::size_t most_entries) {
    Check check{.stage = "samples (adaptive)", .tolerance = node_tolerance};
    const std::size_t pixels = pass_pixels(run.second);
    const std::size_t stride =
        (pixels * std::max<std::size_t>(run.sizes[0], 16) / most_entries) | 1;
    for (std::size_t p = 0; p < pixels; p += stride) {
        const std::size_t item = Run::item(run.second, p);
        if (!run.hit(item)) continue;
        const std::size_t tile = item / (std::size_t{ADAPTIVE_TILE} * ADAPTIVE_TILE);
        const std::size_t cell = item / 16 % 64;
        const reference::Point point{scene, view.of(item), run.surfaces[item]};
        const glm::uvec2 at = item_pixel(run.tiles, item);
        const auto visibility = [&](uint slot) {
            return reference::known_visibility(run.visible[run.place(tile, slot, cell)]);
        };
        glm::dvec3 sum(0);
        double magnitude = 0;
        int undecided = 0;  // terms
        const std::vector<DrawnNode>& draws = run.drawn[p];
        struct DrawnLight {
            const Light* light;
            glm::dvec2 u;
            double weight;
        };
        std::vector<DrawnLight> drawn;
        // The control variate: of all nodes, as they were refined. Those are the cut's nodes, but
        // for what the pixels of the group wanted: its sum comes from the same reference.
        const reference::NodeDraws own = reference::draw_nodes(
            tree, scene, std::span(run.nodes).subspan(tile * CUT_CAPACITY, run.sizes[tile]),
            group_of(run, view, p, false), run.budget)[p % run.lanes];
        sum += double{CONTROL} * own.control;
        magnitude += glm::length(own.control);
        // What rounding does to single lights, such as spots with sharp edges.
        const auto light_rounding = [&] {
            const auto of = [&](const Light& light, const glm::dvec2& u) {
                return reference::rounding_slack(point.surface, point.material(), point.viewer,
                                                 light, u);
            };
            const auto of_node = [&](uint node) {
                const Light& light = tree.lights[tree.nodes[node].first];
                return tree.nodes[node].count > 1 ? 0 : of(light, reference::centroid(light));
            };
            double slack = 0;
            for (uint slot = 0; slot < run.sizes[tile]; ++slot)
                slack += double{CONTROL} * visibility(slot) *
                         of_node(run.nodes[tile * CUT_CAPACITY + slot]);
            for (const DrawnNode& d : draws)
                slack += double{CONTROL} * visibility(d.slot) / double{d.share} * of_node(d.node);
            for (const auto& [light, u, weight] : drawn) slack += weight * of(*light, u);
            return slack;
        };
        for (std::size_t i = 0; i < draws.size(); ++i) {
            const auto [node, slot, share, end] = draws[i];
            std::size_t first = i;  // of the draws of the same node
            std::size_t last = i;
            while (first > 0 && draws[first - 1].node == node) --first;
            while (last + 1 < draws.size() && draws[last + 1].node == node) ++last;
            const glm::dvec3 estimate = reference::node_estimate(tree, node, point);
            const glm::dvec3 taken = double{CONTROL} * visibility(slot) / double{share} * estimate;
            sum -= taken;
            magnitude += glm::length(taken);
            const auto bits = reference::random_bits(
                at.y * run.tiles.width + at.x, run.sample.index,
                1024 * run.second.number + static_cast<uint>(i), run.sample.seed);
            const double u = (static_cast<double>(i - first) + reference::unit_fraction(bits[0])) /
                             static_cast<double>(last - first + 1);
            const reference::Descent d = reference::descend(tree, node, point, u, bits[3]);
            undecided += d.uncertain ? 1 : 0;
            if (d.probability == 0) continue;
            const glm::dvec2 on_light(reference::unit_fraction(bits[1]),
                                      reference::unit_fraction(bits[2]));
            const reference::Unshadowed term = reference::unshadowed(
                point.surface, point.material(), point.viewer, tree.lights[d.light], on_light);
            drawn.push_back({&tree.lights[d.light], on_light, 1 / (double{share} * d.probability)});
            if (term.value == glm::dvec3(0)) continue;
            const glm::dvec3 value = term.value / (double{share} * d.probability);
            magnitude += glm::length(value);
            if (!tracer.occluded(term.shadow)) sum += value;
            undecided += tracer.occlusion_is_borderline(term.shadow, term.rounding) ? 1 : 0;
        }
        const double difference = glm::length(glm::dvec3(run.estimates[item]) - sum);
        double tolerance = 1e-3 * magnitude + darkest;
        if (difference > tolerance) tolerance += light_rounding();
        if (own.uncertain) ++undecided;
        check.excuse(undecided);
        if (difference > tolerance && undecided > 0) {
            check.skip_borderline();
            continue;
        }
        check.compare(difference, tolerance,
                      fmt::format("pixel ({}, {}): {} is not {}", at.x, at.y,
                                  show(run.estimates[item]), show(sum)),
                      magnitude == 0);
    }
    return check;
}

}  // namespace

std::vector<Check> Verifier::adaptive(uint cut_size) {
    if (scene_.lights.empty()) return {};
    Tiles tiles = all_tiles(options_.width, options_.height, ADAPTIVE_TILE);
    tiles.first = tiles.count > most_tiles ? (tiles.count - most_tiles) / 2 : 0;
    tiles.count -= tiles.first;
    const Run run(device_, tree_scene_, tiles, cut_size, options_.seed, points_,
                  [this](const std::vector<Surface>& points) { send_out(points); });
    keep_materials();
    return {check_cuts(run, tree_, scene_, tracer_, view_, cut_size), check_visibility(run, tree_),
            check_weights(run, tree_, scene_, view_, 10 * options_.most_entries),
            check_samples(run, tree_, scene_, tracer_, view_, options_.most_entries)};
}

}  // namespace manylight

// SPDX-License-Identifier: MIT
#include <cmath>

#include "reference/contributions.hpp"
#include "reference/random.hpp"
#include "verify/samplers/adaptive/run.hpp"
#include "verify/tolerances.hpp"

namespace manylight::adaptive_stages {

namespace {

constexpr double darkest = 1e-9;  // cd/m2: a light just below the horizon

}  // namespace

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

}  // namespace manylight::adaptive_stages

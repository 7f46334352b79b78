// SPDX-License-Identifier: MIT
#include "reference/samples.hpp"

#include <algorithm>

#include "reference/light_tree.hpp"
#include "reference/random.hpp"

namespace manylight::reference {
namespace {

// (sample + random / 2^32) / count of `total`: stratified.
uint stratified(uint total, uint sample, uint count, uint random) {
    const std::uint64_t within = (std::uint64_t{total} * random) >> 32;
    return static_cast<uint>((std::uint64_t{total} * sample + within) / count);
}

struct Found {
    uint light;
    uint width;
};

Found search(std::span<const uint> cdf, uint target) {
    uint before = 0;
    for (uint light = 0; light < cdf.size(); ++light) {
        if (target < cdf[light]) return {light, cdf[light] - before};
        before = cdf[light];
    }
    return {0, 0};
}

Choice draw_from(std::span<const uint> cdf, const Draw& draw) {
    const uint total = cdf.back();
    if (total == 0) return {0, 0};
    const uint target = stratified(total, draw.sample, draw.sample_count, draw.bits[0]);
    const Found found = search(cdf, target);
    return {found.light, static_cast<double>(total) / found.width / draw.sample_count};
}

// The probability of a light by a CDF of integers.
double share_of(std::span<const uint> cdf, uint light) {
    const double width = cdf[light] - (light > 0 ? cdf[light - 1] : 0u);
    return cdf.back() > 0 ? width / cdf.back() : 0;
}

constexpr double doubtful = 1e-5;  // difference in a decision that single precision may not see

}  // namespace

Choice choose_exhaustive(const Tables&, const Point&, const Draw& draw) { return {draw.sample, 1}; }

Choice choose_uniform(const Tables&, const Point&, const Draw& draw) {
    return {stratified(draw.light_count, draw.sample, draw.sample_count, draw.bits[0]),
            static_cast<double>(draw.light_count) / draw.sample_count};
}

Choice choose_power(const Tables& tables, const Point&, const Draw& draw) {
    return draw_from(tables.power_cdf, draw);
}

Choice choose_contribution(const Tables& tables, const Point&, const Draw& draw) {
    const std::size_t row = tables.item_rows[draw.item];
    return draw_from(tables.cdf.subspan(row * draw.light_count, draw.light_count), draw);
}

Choice choose_ris(const Tables& tables, const Point& point, const Draw& draw) {
    constexpr uint candidates = 32;
    const glm::dvec2 u(unit_fraction(draw.bits[1]), unit_fraction(draw.bits[2]));
    const uint total = tables.power_cdf.back();
    if (total == 0) return {0, 0};
    Choice choice{0, 0};
    double sum = 0;
    double chosen = 0;
    double slack = 0;
    for (uint i = 0; i < candidates; ++i) {
        const uint target = stratified(total, i * draw.sample_count + draw.sample,
                                       candidates * draw.sample_count, step_bits(draw.bits[0], i));
        const Found found = search(tables.power_cdf, target);
        const double contribution =
            luminance(unshadowed(point.surface, point.material(), point.camera,
                                 point.scene.lights[found.light], u)
                          .value);
        const double weight = contribution / found.width;
        sum += weight;
        if (draw.judge)
            slack += rounding_slack(point.surface, point.material(), point.camera,
                                    point.scene.lights[found.light], u) /
                     found.width;
        if (sum == 0) continue;
        const double share = weight / sum - unit_fraction(step_bits(draw.bits[3], i));
        if (weight > 0 && std::abs(share) < doubtful) choice.borderline = true;
        if (share <= 0) continue;
        choice.light = found.light;
        chosen = contribution;
    }
    if (chosen == 0) return choice;
    choice.weight = sum * total / (chosen * candidates * draw.sample_count);
    choice.slack = slack / sum;
    return choice;
}

Choice choose_lighttree(const Tables& tables, const Point& point, const Draw& draw) {
    const std::vector<LightNode>& nodes = tables.tree->nodes;
    Choice choice{0, 0};
    double u = (draw.sample + unit_fraction(draw.bits[0])) / draw.sample_count;
    double probability = 1;
    double blur = doubtful;  // of u
    std::size_t at = 0;
    for (uint step = tables.tree->roots.size() > 1 ? 0 : 1; step == 0 || nodes[at].count > 1;
         ++step) {
        const std::size_t left = step == 0 ? 0 : at + 1;
        const std::size_t right = step == 0 ? tables.tree->roots[1] : at + 2 * nodes[at + 1].count;
        const double a = importance(nodes[left], point.surface);
        const double b = importance(nodes[right], point.surface);
        if (a + b == 0) return {0, 0, choice.borderline};
        const double expected = probability * draw.sample_count;
        if (std::abs(expected - 1) < doubtful) choice.borderline = true;
        if (expected < 1) {
            u = unit_fraction(step_bits(draw.bits[3], step));
            blur = doubtful;
        }
        const double p = a / (a + b);
        if (std::abs(u - p) < blur) choice.borderline = true;
        const bool go_left = u < p;
        const double taken = go_left ? p : 1 - p;
        u = (go_left ? u : u - p) / taken;
        blur = (blur + doubtful) / taken;
        probability *= taken;
        at = go_left ? left : right;
    }
    choice.light = tables.tree->order[nodes[at].first];
    choice.weight = 1 / (probability * draw.sample_count);
    return choice;
}

double probability_uniform(const Tables&, const Point& point, std::size_t, uint) {
    return 1.0 / static_cast<double>(point.scene.lights.size());
}

double probability_power(const Tables& tables, const Point&, std::size_t, uint light) {
    return share_of(tables.power_cdf, light);
}

double probability_contribution(const Tables& tables, const Point& point, std::size_t item,
                                uint light) {
    const std::size_t count = point.scene.lights.size();
    return share_of(tables.cdf.subspan(tables.item_rows[item] * count, count), light);
}

// The product of the choices on the way down to the light's leaf.
double probability_lighttree(const Tables& tables, const Point& point, std::size_t, uint light) {
    const LightTree& tree = *tables.tree;
    const auto place = static_cast<uint>(std::ranges::find(tree.order, light) - tree.order.begin());
    double probability = 1;
    std::size_t at = 0;
    for (bool root = tree.roots.size() > 1; root || tree.nodes[at].count > 1; root = false) {
        const std::size_t left = root ? 0 : at + 1;
        const std::size_t right = root ? tree.roots[1] : at + 2 * tree.nodes[at + 1].count;
        const double a = importance(tree.nodes[left], point.surface);
        const double b = importance(tree.nodes[right], point.surface);
        if (a + b == 0) return 0;
        const bool is_right = place >= tree.nodes[right].first &&
                              place < tree.nodes[right].first + tree.nodes[right].count;
        probability *= (is_right ? b : a) / (a + b);
        at = is_right ? right : left;
    }
    return probability;
}

Estimate estimate(const Scene& scene, const Tracer& tracer, const Camera& camera,
                  const Surface& surface, const Tables& tables, ChooseLight choose,
                  std::size_t item, uint pixel, uint pixel_sample, uint seed, uint sample_count,
                  bool judge) {
    Estimate out;
    if (surface.position.w < 0) return out;
    const Material& material = scene.materials[surface.shading];
    const auto lights = static_cast<uint>(scene.lights.size());
    for (uint sample = 0; sample < sample_count; ++sample) {
        const auto bits = random_bits(pixel, pixel_sample, sample, seed);
        const Choice choice = choose(tables, {scene, camera, surface},
                                     {item, sample, sample_count, bits, lights, judge});
        out.uncertain = out.uncertain || choice.borderline;
        out.undecided += choice.borderline ? 1 : 0;
        if (choice.weight == 0) continue;
        const Light& light = scene.lights[choice.light];
        const glm::dvec2 u(unit_fraction(bits[1]), unit_fraction(bits[2]));
        const Unshadowed term = unshadowed(surface, material, camera, light, u);
        if (judge) out.slack += choice.weight * rounding_slack(surface, material, camera, light, u);
        if (term.value == glm::dvec3(0)) continue;
        const glm::dvec3 value = term.value * choice.weight;
        out.slack += choice.slack * glm::length(value);
        if (!tracer.occluded(term.shadow)) {
            out.value += value;
            out.magnitude += value;
        }
        if (judge && tracer.occlusion_is_borderline(term.shadow, term.rounding)) {
            out.borderline += glm::length(value);
            ++out.undecided;
        }
    }
    return out;
}

}  // namespace manylight::reference

// SPDX-License-Identifier: MIT
#include "reference/adaptive.hpp"

#include <algorithm>
#include <cmath>

#include "reference/random.hpp"

namespace manylight::reference {
namespace {

bool single_point(const LightNode& node) {
    return node.kind != NODE_GROUP && !light_has(node.kind, TRAIT_AREA);
}

struct Entry {
    uint slot, node;
};

// What pixels are drawn by.
struct Drawer {
    const LightTree& tree;
    const Scene& scene;
    const Budget& budget;

    [[nodiscard]] glm::dvec3 estimate(const Entry& e, const DrawnPixel& p) const {
        return p.surface ? node_estimate(tree, e.node, {scene, p.viewer, *p.surface})
                         : glm::dvec3(0);
    }

    // `hidden` scales what is believed hidden.
    [[nodiscard]] double weight(const Entry& e, const DrawnPixel& p, double hidden) const {
        // Its mean is the contribution x V^, of which a part is the control variate's.
        const double v = std::abs(p.visible[e.slot]);
        const double variance = tree.nodes[e.node].count > 1 ? double{GROUP_VARIANCE} : 0;
        const double known = CONTROL * (2 - double{CONTROL}) * known_visibility(p.visible[e.slot]);
        return luminance(estimate(e, p)) * std::sqrt(v * (1 + variance - known)) *
               (is_hidden(e, p) ? hidden : 1);
    }

    [[nodiscard]] static bool is_hidden(const Entry& e, const DrawnPixel& p) {
        return p.visible[e.slot] < double{HIDDEN_VISIBILITY};
    }

    // How near a node is to a pixel, for its size: 1 within it.
    [[nodiscard]] double nearness(const LightNode& node, const Surface& s) const {
        const double distance = glm::length(glm::dvec3(node.centre) - glm::dvec3(s.position));
        return NODE_IS_INFINITE(node) ? double{node.intensity.w}
                                      : std::min(node.intensity.w / std::max(distance, 1e-20), 1.0);
    }
};

std::vector<Entry> entries_of(std::span<const uint> cut) {
    std::vector<Entry> list;
    for (uint slot = 0; slot < cut.size(); ++slot) list.push_back({slot, cut[slot]});
    return list;
}

// What the weights of nodes that are believed hidden are scaled by, so that they are no more than
// their share of all weights of the cut.
double hidden_scale(const Drawer& drawer, std::span<const uint> cut, const DrawnPixel& pixel) {
    double seen = 0;
    double hidden = 0;
    for (const Entry& e : entries_of(cut))
        (Drawer::is_hidden(e, pixel) ? hidden : seen) += drawer.weight(e, pixel, 1);
    const double most = HIDDEN_SHARE * seen / (1 - double{HIDDEN_SHARE});
    return most > 0 && hidden > most ? most / hidden : 1;
}

// The cut, in which what is close to any of the pixels is replaced by its children.
std::vector<Entry> refine(const Drawer& drawer, std::span<const uint> cut,
                          std::span<const DrawnPixel> pixels, std::span<const double> scales,
                          bool& uncertain) {
    const LightTree& tree = drawer.tree;
    std::vector<Entry> list = entries_of(cut);
    std::vector<double> sums(pixels.size(), 0);
    for (const Entry& e : list)
        for (std::size_t i = 0; i < pixels.size(); ++i)
            sums[i] += drawer.weight(e, pixels[i], scales[i]);
    int splits = 0;
    for (std::size_t at = 0; at < list.size();) {
        const Entry e = list[at];
        const LightNode& node = tree.nodes[e.node];
        bool wanted = false;
        for (std::size_t i = 0; i < pixels.size() && node.count > 1; ++i) {
            if (!pixels[i].surface) continue;
            const double limit = sums[i] * double{REFINED_SHARE} / drawer.budget.samples;
            const double size =
                drawer.weight(e, pixels[i], scales[i]) * drawer.nearness(node, *pixels[i].surface);
            wanted = wanted || size > limit;
            if (size > 0 && std::abs(size / limit - 1) < doubtful / 4) uncertain = true;
        }
        if (!wanted || splits >= MOST_SPLITS) {
            ++at;
            continue;
        }
        ++splits;
        const Entry children[] = {{e.slot, e.node + 1}, {e.slot, right_child(tree, e.node)}};
        list[at] = children[0];
        list.insert(list.begin() + static_cast<std::ptrdiff_t>(at) + 1, children[1]);
    }
    return list;
}

// How many draws a pixel gets, which `rounding` makes a whole number.
double draw_count(const Budget& budget, double variance, double brightness, double rounding,
                  bool& uncertain) {
    if (!(budget.factor > 0)) return budget.samples;
    const double wanted = budget.factor * budget.exposure *
                          std::sqrt(variance / (std::pow(brightness * budget.exposure, 2) + 0.01));
    const double samples =
        std::clamp<double>(wanted, FEWEST_DRAWS * budget.samples, MOST_DRAWS * budget.samples);
    if (std::abs(wanted - 1) < doubtful) uncertain = true;
    if (samples < 1) return samples;
    const double exact = samples + rounding;
    if (std::abs(exact - std::round(exact)) < doubtful * samples) uncertain = true;
    return std::floor(exact);
}

// Draws per weight, so that all are drawn, and no single point more than once.
double draw_scale(const LightTree& tree, std::span<const Entry> list,
                  std::span<const double> weights, double sum, double samples) {
    const double all = samples * 0.999999;
    double scale = sum > 0 ? all / sum : 0;
    for (int round = 0; round < 8 && sum > 0; ++round) {
        double rest = 0;
        double certain = 0;
        for (std::size_t i = 0; i < list.size(); ++i) {
            if (single_point(tree.nodes[list[i].node]) && weights[i] * scale >= 1)
                certain += 1;
            else
                rest += weights[i];
        }
        if (!(rest > 0 && all - certain > 0.01)) break;
        scale = std::max((all - certain) / rest, scale);
    }
    return scale;
}

NodeDraws draw_pixel(const Drawer& drawer, std::span<const Entry> list, const DrawnPixel& pixel,
                     double hidden) {
    const LightTree& tree = drawer.tree;
    NodeDraws d;
    std::vector<double> weights;
    double sum = 0;
    double estimates_blur = 0;
    for (const Entry& e : list) {
        d.control += known_visibility(pixel.visible[e.slot]) * drawer.estimate(e, pixel);
        weights.push_back(drawer.weight(e, pixel, hidden));
        sum += weights.back();
        estimates_blur +=
            estimate_rounding(tree, e.node, {drawer.scene, pixel.viewer, *pixel.surface});
    }
    // Where weights are hardly more than rounding, so is what is drawn.
    if (estimates_blur > 2e-4 * sum) d.uncertain = true;
    const double brightness = luminance(d.control);
    const double unknown = 1 - double{CONTROL};
    d.variance = std::max(
        sum * sum - (unknown * unknown - double{PIXEL_VARIANCE}) * brightness * brightness, 0.0);
    const double samples =
        draw_count(drawer.budget, d.variance, brightness, pixel.starts.rounding, d.uncertain);
    const double scale = draw_scale(tree, list, weights, sum, samples);
    double position = pixel.starts.position;
    double blur = 1e-6;  // of the position
    for (std::size_t i = 0; i < list.size(); ++i) {
        const double exact_share = weights[i] * scale;
        const bool single = single_point(tree.nodes[list[i].node]);
        const double share = single ? std::min(exact_share, 1.0) : exact_share;
        const double reached = position + share;
        blur += 1e-5 * share + 1e-7;
        // Close to where a draw begins, but for nodes that are passed exactly.
        const double whole = std::round(reached);
        if (whole > 0 && std::abs(reached - whole) < blur) d.uncertain = true;
        d.nodes.push_back({list[i].slot, list[i].node, share, weights[i],
                           luminance(drawer.estimate(list[i], pixel))});
        for (int k = 0; k < static_cast<int>(reached); ++k) d.draws.push_back(d.nodes.back());
        position = reached - std::floor(reached);
    }
    return d;
}

float shifted_gradient_noise(uint x, uint y, float shift) {
    const auto fraction = [](float v) { return std::min(v - std::floor(v), 0x1.fffffep-1f); };
    const float inner =
        fraction(0.06711056f * static_cast<float>(x) + 0.00583715f * static_cast<float>(y));
    return fraction(52.9829189f * inner + shift);
}

}  // namespace

std::vector<NodeDraws> draw_nodes(const LightTree& tree, const Scene& scene,
                                  std::span<const uint> cut, std::span<const DrawnPixel> pixels,
                                  const Budget& budget) {
    const Drawer drawer{tree, scene, budget};
    bool doubt = false;
    std::vector<double> scales;
    for (const DrawnPixel& pixel : pixels) scales.push_back(hidden_scale(drawer, cut, pixel));
    const std::vector<Entry> list = refine(drawer, cut, pixels, scales, doubt);
    std::vector<NodeDraws> out;
    for (std::size_t i = 0; i < pixels.size(); ++i) {
        NodeDraws& d = out.emplace_back();
        if (pixels[i].surface) d = draw_pixel(drawer, list, pixels[i], scales[i]);
        d.uncertain = d.uncertain || doubt;
    }
    return out;
}

Descent descend(const LightTree& tree, uint node, const Point& point, double u, uint bits) {
    Descent d{0, 1};
    for (uint step = 0; tree.nodes[node].count > 1; ++step) {
        const uint right = right_child(tree, node);
        const double a = luminance(node_estimate(tree, node + 1, point));
        const double b = luminance(node_estimate(tree, right, point));
        if (a + b == 0) return {0, 0, d.uncertain};
        if (step > 0) u = unit_fraction(step_bits(bits, step));
        const double p = a / (a + b);
        if (std::abs(u - p) < 1e-5) d.uncertain = true;
        d.probability *= u < p ? p : 1 - p;
        node = u < p ? node + 1 : right;
    }
    d.light = tree.nodes[node].first;
    return d;
}

Starts draw_starts(uint x, uint y, const Pass& pass, uint pixel_sample, uint seed) {
    const auto bits = random_bits(16 * pass.number + pass.first, pixel_sample, 0xfffffffdu, seed);
    const auto shift = [&](int i) { return static_cast<float>(unit_fraction(bits[i])); };
    return {shifted_gradient_noise(x, y, shift(0)), shifted_gradient_noise(y, x, shift(1))};
}

}  // namespace manylight::reference

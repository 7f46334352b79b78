// SPDX-License-Identifier: MIT
#include "reference/samplers/lighttree.hpp"

#include <algorithm>

#include "reference/light_tree.hpp"
#include "reference/random.hpp"

namespace manylight::reference {

Choice DownLightTree::choose(const Point& point, const Draw& draw) const {
    const std::vector<LightNode>& nodes = tree_.nodes;
    Choice choice{0, 0};
    double u = (draw.sample + unit_fraction(draw.bits[0])) / draw.sample_count;
    double probability = 1;
    double blur = doubtful_draw;  // of u
    std::size_t at = 0;
    for (uint step = tree_.roots.size() > 1 ? 0 : 1; step == 0 || nodes[at].count > 1; ++step) {
        const std::size_t left = step == 0 ? 0 : at + 1;
        const std::size_t right = step == 0 ? tree_.roots[1] : at + 2 * nodes[at + 1].count;
        const double a = importance(nodes[left], point.surface);
        const double b = importance(nodes[right], point.surface);
        if (a + b == 0) return {0, 0, choice.borderline};
        const double expected = probability * draw.sample_count;
        if (std::abs(expected - 1) < doubtful_draw) choice.borderline = true;
        if (expected < 1) {
            u = unit_fraction(step_bits(draw.bits[3], step));
            blur = doubtful_draw;
        }
        const double p = a / (a + b);
        if (std::abs(u - p) < blur) choice.borderline = true;
        const bool go_left = u < p;
        const double taken = go_left ? p : 1 - p;
        u = (go_left ? u : u - p) / taken;
        blur = (blur + doubtful_draw) / taken;
        probability *= taken;
        at = go_left ? left : right;
    }
    choice.light = tree_.order[nodes[at].first];
    choice.weight = 1 / (probability * draw.sample_count);
    return choice;
}

// The product of the choices on the way down to the light's leaf.
std::optional<double> DownLightTree::probability(const Point& point, std::size_t /*item*/,
                                                 uint light) const {
    const auto place =
        static_cast<uint>(std::ranges::find(tree_.order, light) - tree_.order.begin());
    double probability = 1;
    std::size_t at = 0;
    for (bool root = tree_.roots.size() > 1; root || tree_.nodes[at].count > 1; root = false) {
        const std::size_t left = root ? 0 : at + 1;
        const std::size_t right = root ? tree_.roots[1] : at + 2 * tree_.nodes[at + 1].count;
        const double a = importance(tree_.nodes[left], point.surface);
        const double b = importance(tree_.nodes[right], point.surface);
        if (a + b == 0) return 0;
        const bool is_right = place >= tree_.nodes[right].first &&
                              place < tree_.nodes[right].first + tree_.nodes[right].count;
        probability *= (is_right ? b : a) / (a + b);
        at = is_right ? right : left;
    }
    return probability;
}

}  // namespace manylight::reference

// SPDX-License-Identifier: MIT
#include "reference/samplers/stochastic_lightcuts.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "reference/light_tree.hpp"
#include "reference/random.hpp"
#include "shared/stochastic_lightcuts.h"

namespace manylight::reference {
namespace {

constexpr double near_tie = 1e-4;  // of two bounds, relative

bool is_leaf(const LightTree& tree, uint node) {
    return node != BOTH_ROOTS && tree.nodes[node].count == 1;
}

std::array<uint, 2> children_of(const LightTree& tree, uint node) {
    if (node == BOTH_ROOTS) return {tree.roots[0], tree.roots[1]};
    return {node + 1, node + 2 * tree.nodes[node + 1].count};
}

uint top_of(const LightTree& tree) { return tree.roots.size() > 1 ? BOTH_ROOTS : tree.roots[0]; }

// Distances to the bounds' nearest and farthest points, squared.
std::array<double, 2> distances2(const LightNode& node, const Surface& surface) {
    std::array<double, 2> sums{};
    for (int axis = 0; axis < 3; ++axis) {
        const double p = surface.position[axis];
        const double below = double{node.lower[axis]} - p;
        const double above = p - double{node.upper[axis]};
        sums[0] += std::pow(std::max({below, above, 0.0}), 2);
        sums[1] += std::pow(std::max(std::abs(below), std::abs(above)), 2);
    }
    return sums;
}

double reach(const LightNode& node, const Surface& surface) {
    return luminance(glm::dvec3(node.intensity)) * view_node(node, surface).cosines;
}

// The probability of the first of two siblings in proportion to two numbers.
double first_of(double a, double b) { return a + b > 0 ? a / (a + b) : 0; }

// The probability that the left child is taken, none where none shines on the point.
std::optional<double> left_probability(const LightTree& tree, uint parent, const Surface& surface) {
    const auto [left, right] = children_of(tree, parent);
    const LightNode& a = tree.nodes[left];
    const LightNode& b = tree.nodes[right];
    if (parent == BOTH_ROOTS) {
        const double bound_a = illuminance_bound(a, surface);
        const double bound_b = illuminance_bound(b, surface);
        if (bound_a + bound_b == 0) return {};
        return first_of(bound_a, bound_b);
    }
    const double reach_a = reach(a, surface);
    const double reach_b = reach(b, surface);
    if (reach_a + reach_b == 0) return {};
    const double by_reach = first_of(reach_a, reach_b);
    if (NODE_IS_INFINITE(a)) return by_reach;
    const auto [near_a, far_a] = distances2(a, surface);
    const auto [near_b, far_b] = distances2(b, surface);
    const double by_nearest =
        near_a == 0 || near_b == 0 ? by_reach : first_of(reach_a / near_a, reach_b / near_b);
    return (by_nearest + first_of(reach_a / far_a, reach_b / far_b)) / 2;
}

// Where draws from a node are on their way down.
struct Descent {
    uint node;
    double probability = 1;
    double slack = 0;  // of the probability, relative
    bool dead = false;
    bool borderline = false;
};

Descent descend(const LightTree& tree, const Surface& surface, uint from, uint i, uint n,
                const std::array<uint, 4>& bits) {
    Descent at{from};
    double u = (i + unit_fraction(bits[0])) / n;
    double blur = doubtful_draw;  // of u
    for (uint step = 0; !is_leaf(tree, at.node); ++step) {
        const std::optional<double> p = left_probability(tree, at.node, surface);
        const auto [left, right] = children_of(tree, at.node);
        const NodeView views[2] = {view_node(tree.nodes[left], surface),
                                   view_node(tree.nodes[right], surface)};
        at.dead = !p;
        if (at.dead) at.borderline |= views[0].doubtful || views[1].doubtful;
        if (at.dead) return at;
        const double expected = at.probability * n;
        if (std::abs(expected - 1) < doubtful_draw && n > 1) at.borderline = true;
        if (expected < 1) {
            u = unit_fraction(step_bits(bits[3], step));
            blur = doubtful_draw;
        }
        const bool go_left = u < *p;
        const double taken = go_left ? *p : 1 - *p;
        const double slack = views[0].slack + views[1].slack;
        if (std::abs(u - *p) < blur + slack * *p * (1 - *p)) at.borderline = true;
        if (views[go_left ? 0 : 1].doubtful) at.borderline = true;
        u = (go_left ? u : u - *p) / taken;
        blur = (blur + doubtful_draw) / taken;
        at.slack += (1 - taken) * slack;
        at.probability *= taken;
        at.node = go_left ? left : right;
    }
    return at;
}

}  // namespace

double illuminance_bound(const LightNode& node, const Surface& surface) {
    if (NODE_IS_INFINITE(node)) return reach(node, surface);
    const double radius = view_node(node, surface).radius;
    const double squared = std::max(distances2(node, surface)[0], radius * radius);
    return squared > 0 ? reach(node, surface) / squared : 0;
}

LightCut light_cut(const LightTree& tree, const Surface& surface, uint size) {
    LightCut cut;
    std::set<uint> rivals;  // that were nearly split in another's place
    struct Node {
        uint index;
        double bound;  // -1: cannot be split
    };
    std::vector<Node> nodes;
    const uint top = top_of(tree);
    nodes.push_back({top, is_leaf(tree, top) ? -1 : std::numeric_limits<double>::infinity()});
    while (!nodes.empty() && nodes.size() < size) {
        const auto largest = std::ranges::max_element(nodes, {}, &Node::bound);
        if (largest->bound < 0) break;
        for (const Node& other : nodes)
            if (&other != &*largest && other.bound > (1 - near_tie) * largest->bound)
                rivals.insert(other.index);
        const auto children = children_of(tree, largest->index);
        auto place = nodes.erase(largest);
        for (const uint child : {children[1], children[0]}) {
            const LightNode& node = tree.nodes[child];
            const double bound = illuminance_bound(node, surface);
            cut.doubtful = cut.doubtful || view_node(node, surface).doubtful;
            if (bound > 0) place = nodes.insert(place, {child, node.count == 1 ? -1 : bound});
        }
    }
    for (const Node& node : nodes) {
        cut.nodes.push_back(node.index);
        cut.doubtful = cut.doubtful || rivals.contains(node.index);
    }
    return cut;
}

Choice StochasticLightcuts::choose(const Point& point, const Draw& draw) const {
    const uint round = draw.sample / MOST_CUT_NODES;
    const uint size = std::min<uint>(draw.sample_count - round * MOST_CUT_NODES, MOST_CUT_NODES);
    const LightCut cut = light_cut(tree_, point.surface, std::min(size, cut_nodes_));
    if (cut.nodes.empty()) return {0, 0, cut.doubtful};
    // The samples of the round that have the same node.
    const auto count = static_cast<uint>(cut.nodes.size());
    const auto place_of = [&](uint sample) { return sample * count / size; };
    const uint sample = draw.sample % MOST_CUT_NODES;
    uint before = 0;
    uint alike = 0;
    for (uint other = 0; other < size; ++other) {
        if (place_of(other) != place_of(sample)) continue;
        before += other < sample ? 1 : 0;
        ++alike;
    }
    const Descent found =
        descend(tree_, point.surface, cut.nodes[place_of(sample)], before, alike, draw.bits);
    const bool borderline = cut.doubtful || found.borderline;
    if (found.dead) return {0, 0, borderline};
    const double weight = double(size) / draw.sample_count / (alike * found.probability);
    return {tree_.order[tree_.nodes[found.node].first], weight, borderline, found.slack};
}

std::optional<double> StochasticLightcuts::probability(const Point& point, std::size_t /*item*/,
                                                       uint light) const {
    return probability_from(top_of(tree_), light, point.surface);
}

// A round's cut, its samples one by one: each draws from the node of its place.
std::optional<ExpectedCount> StochasticLightcuts::expected_count(const Point& point,
                                                                 std::size_t /*item*/, uint light,
                                                                 uint sample_count) const {
    ExpectedCount out;
    for (uint first = 0; first < sample_count; first += MOST_CUT_NODES) {
        const uint size = std::min<uint>(sample_count - first, MOST_CUT_NODES);
        const LightCut cut = light_cut(tree_, point.surface, std::min(size, cut_nodes_));
        double expected = 0;
        for (uint sample = 0; sample < size && !cut.nodes.empty(); ++sample) {
            const std::size_t place = sample * cut.nodes.size() / size;
            expected += probability_from(cut.nodes[place], light, point.surface);
        }
        out.doubtful = out.doubtful || cut.doubtful;
        out.rounds.push_back({double(size) / sample_count, expected * sample_count / size});
    }
    return out;
}

double StochasticLightcuts::probability_from(uint node, uint light, const Surface& surface) const {
    const auto place = static_cast<uint>(std::ranges::find(tree_.order, light) -  //
                                         tree_.order.begin());
    const auto holds = [&](const LightNode& n) {
        return place >= n.first && place < n.first + n.count;
    };
    if (node != BOTH_ROOTS && !holds(tree_.nodes[node])) return 0;
    double probability = 1;
    while (!is_leaf(tree_, node)) {
        const std::optional<double> p = left_probability(tree_, node, surface);
        if (!p) return 0;
        const auto [left, right] = children_of(tree_, node);
        const bool go_left = place < tree_.nodes[right].first;
        probability *= go_left ? *p : 1 - *p;
        node = go_left ? left : right;
    }
    return probability;
}

}  // namespace manylight::reference

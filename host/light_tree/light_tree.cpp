// SPDX-License-Identifier: MIT
#include "light_tree/light_tree.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <future>
#include <glm/gtc/constants.hpp>
#include <thread>

#include "lights/lights.hpp"

namespace manylight {
namespace {

constexpr int bin_count = 12;
constexpr int deepest_split = 64;         // below, halves: bounds the depth whatever the input
constexpr std::size_t task_size = 8'192;  // lights worth a thread of their own
constexpr double pi = glm::pi<double>();
// By which cones are wider than they need be, for their axes are rounded, radians.
constexpr double cone_margin = 1e-6;

// What the splits look at.
struct Reference {
    glm::vec3 position;
    float power;
    glm::vec3 axis;  // power times emission axis
    std::uint32_t light;
};

// 1 - cos(angle), and back: unlike the cosine, it tells small angles apart.
float versine_of(double angle) {
    const double s = std::sin(angle / 2);
    return static_cast<float>(2 * s * s);
}

double angle_of(float versine) { return 2 * std::asin(std::sqrt(std::min(versine / 2.0, 1.0))); }

double angle_between(const glm::dvec3& a, const glm::dvec3& b) {
    return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
}

// The share of a light of two sides that counts as without axis.
constexpr float two_sides = 0.5f;

// A node of one light.
LightNode leaf_of(const Light& light, uint index) {
    LightNode node{};
    node.first = index;
    node.count = 1;
    node.kind = kind_of(light);
    node.reach = -1;
    const Extent<float> extent = extent_of<float>(light);
    Bounds bounds;
    float radius = 0;
    for (const glm::vec3& corner : extent.corners) {
        bounds.add(corner);
        radius = std::max(radius, glm::length(corner - extent.centre));
    }
    const bool axial = has_axis(light);
    const glm::vec3 axis = axis_of(light);
    node.centre = float4(extent.centre, extent.mean_square);
    node.axis = shines_to_both_sides(light)
                    ? float4(glm::vec3(glm::normalize(area_normal(light))), two_sides)
                    : float4(axis, axial ? 0 : 1);
    node.intensity = float4(glm::vec3(light.emission) * extent.area, radius);
    float emitting = axial ? 1 : 2;
    if (light_has(light, TRAIT_CONE))
        emitting = std::min(versine_of(angle_of(light.edge.y) + cone_margin), 1.f);
    node.lower = float4(bounds.lower, axial || NODE_IS_INFINITE(node) ? 0 : 2);
    node.upper = float4(bounds.upper, emitting);
    node.cone = float4(axial ? axis : glm::vec3(0, 0, 1), light.emission.w);
    return node;
}

// The cone that holds two cones, each an axis and 1 - the cosine of its half angle (pbrt-v4,
// DirectionCone's Union).
float4 join_cones(const float4& a, const float4& b) {
    const double angle_a = angle_of(a.w);
    const double angle_b = angle_of(b.w);
    const glm::dvec3 axis_a{glm::vec3(a)};
    const glm::dvec3 axis_b{glm::vec3(b)};
    const double between = angle_between(axis_a, axis_b);
    if (std::min(between + angle_b, pi) <= angle_a) return a;
    if (std::min(between + angle_a, pi) <= angle_b) return b;
    const double angle = (angle_a + between + angle_b) / 2 + cone_margin;
    const glm::dvec3 turn = glm::cross(axis_a, axis_b);
    if (angle >= pi || glm::dot(turn, turn) == 0) return {0, 0, 1, 2};
    const double by = angle - angle_a;
    const glm::dvec3 side = glm::normalize(glm::cross(turn, axis_a));
    const glm::dvec3 axis = glm::normalize(std::cos(by) * axis_a + std::sin(by) * side);
    return {glm::vec3(axis), versine_of(angle)};
}

// The mean emission axis of the node's lights, and in w the share of those without one.
float4 mean_axis(const LightNode& node) {
    const bool two_sided = node.kind != NODE_GROUP && node.axis.w == two_sides;
    return two_sided ? float4(0, 0, 0, two_sides) : node.axis;
}

float phi(const LightNode& node) { return luminance(glm::vec3(node.intensity)); }

// See LightNode::reach; from the cone of axes and the largest angle off any of them.
float reach_of(const LightNode& node) {
    const glm::vec3 axis(node.axis);
    if (node.upper.w >= 1 || axis == glm::vec3(0)) return -1;
    const double angle = angle_between(glm::dvec3(axis), glm::dvec3(glm::vec3(node.cone))) +
                         angle_of(node.lower.w) + angle_of(node.upper.w);
    return angle < pi ? std::max(static_cast<float>(std::cos(angle)) - 1e-4f, -1.f) : -1;
}

LightNode join(const LightNode& a, const LightNode& b) {
    LightNode node{};
    node.first = a.first;
    node.count = a.count + b.count;
    node.kind = NODE_IS_INFINITE(a) ? NODE_DIRECTIONS : NODE_GROUP;
    const float sum = phi(a) + phi(b);
    const float wa = sum > 0 ? phi(a) / sum : 0.5f;
    const float wb = sum > 0 ? phi(b) / sum : 0.5f;
    const glm::vec3 ca(a.centre);
    const glm::vec3 cb(b.centre);
    const glm::vec3 apart = cb - ca;
    node.centre = float4(ca + wb * apart,
                         wa * a.centre.w + wb * b.centre.w + wa * wb * glm::dot(apart, apart));
    node.axis = wa * mean_axis(a) + wb * mean_axis(b);
    const glm::vec3 lower = glm::min(glm::vec3(a.lower), glm::vec3(b.lower));
    const glm::vec3 upper = glm::max(glm::vec3(a.upper), glm::vec3(b.upper));
    const glm::vec3 c(node.centre);
    const float by_box = glm::length(glm::max(c - lower, upper - c));
    const float by_children = std::max(glm::length(ca - c) + a.intensity.w,  //
                                       glm::length(cb - c) + b.intensity.w);
    node.intensity =
        float4(glm::vec3(a.intensity) + glm::vec3(b.intensity), std::min(by_box, by_children));
    const float4 cone = join_cones(float4(glm::vec3(a.cone), a.lower.w),  //
                                   float4(glm::vec3(b.cone), b.lower.w));
    node.lower = float4(lower, cone.w);
    node.upper = float4(upper, std::max(a.upper.w, b.upper.w));
    node.cone = float4(glm::vec3(cone), a.cone.w + b.cone.w);
    node.reach = reach_of(node);
    return node;
}

struct Bin {
    Bounds bounds;
    float power = 0;
    glm::vec3 axis{0};
    std::uint32_t count = 0;

    void add(const Bin& b) {
        bounds.lower = glm::min(bounds.lower, b.bounds.lower);
        bounds.upper = glm::max(bounds.upper, b.bounds.upper);
        power += b.power;
        axis += b.axis;
        count += b.count;
    }
    [[nodiscard]] float cost() const {
        const glm::vec3 diagonal = bounds.upper - bounds.lower;
        const float spread = 2 - (power > 0 ? std::min(glm::length(axis) / power, 1.f) : 0);
        return power * glm::dot(diagonal, diagonal) * spread;
    }
};

class Builder {
  public:
    Builder(const std::vector<Light>& lights, LightTree& tree) : lights_(lights), tree_(tree) {
        while ((1u << task_depth_) < 4 * std::max(std::thread::hardware_concurrency(), 1u))
            ++task_depth_;
    }

    // Appends the tree of these lights, of which the first `seen` are on the left.
    void build(std::vector<Reference> references, std::size_t seen) {
        if (references.empty()) return;
        first_split_ = seen > 0 && seen < references.size() ? seen : 0;
        const std::size_t root = tree_.nodes.size();
        first_light_ = tree_.lights.size();
        references_ = std::move(references);
        tree_.roots.push_back(static_cast<uint>(root));
        tree_.nodes.resize(root + 2 * references_.size() - 1);
        tree_.lights.resize(first_light_ + references_.size());
        tree_.order.resize(tree_.lights.size());
        build_node(root, 0, references_.size(), 0);
    }

  private:
    void build_node(std::size_t index, std::size_t begin, std::size_t end, int depth) {
        if (end - begin == 1) {
            const std::size_t place = first_light_ + begin;
            tree_.order[place] = references_[begin].light;
            tree_.lights[place] = lights_[references_[begin].light];
            tree_.nodes[index] = leaf_of(tree_.lights[place], static_cast<uint>(place));
            return;
        }
        const std::size_t middle =
            depth == 0 && first_split_ > 0 ? first_split_ : split(begin, end, depth);
        const std::size_t left = index + 1;
        const std::size_t right = index + 2 * (middle - begin);
        const auto build_right = [&] { build_node(right, middle, end, depth + 1); };
        if (end - begin >= task_size && depth < task_depth_) {
            std::future<void> task = std::async(std::launch::async, build_right);
            build_node(left, begin, middle, depth + 1);
            task.get();
        } else {
            build_node(left, begin, middle, depth + 1);
            build_right();
        }
        tree_.nodes[index] = join(tree_.nodes[left], tree_.nodes[right]);
    }

    // Puts the left side's references first and returns where the right side's begin.
    std::size_t split(std::size_t begin, std::size_t end, int depth) {
        const std::size_t half = begin + (end - begin) / 2;
        if (end - begin == 2 || depth >= deepest_split) return half;
        Bounds bounds;
        for (std::size_t i = begin; i < end; ++i) bounds.add(references_[i].position);
        const glm::vec3 size = bounds.upper - bounds.lower;
        const float longest = std::max({size.x, size.y, size.z});
        glm::vec3 scale(0);
        for (int axis = 0; axis < 3; ++axis)
            if (size[axis] > 0 && std::isfinite(bin_count * 0.9999f / size[axis]))
                scale[axis] = bin_count * 0.9999f / size[axis];
        const auto bin_of = [&](const Reference& r, int axis) {
            return static_cast<int>((r.position[axis] - bounds.lower[axis]) * scale[axis]);
        };
        std::array<std::array<Bin, bin_count>, 3> bins;
        for (std::size_t i = begin; i < end; ++i)
            for (int axis = 0; axis < 3; ++axis) {
                Bin& bin = bins[axis][bin_of(references_[i], axis)];
                bin.bounds.add(references_[i].position);
                bin.power += references_[i].power;
                bin.axis += references_[i].axis;
                ++bin.count;
            }
        int best_axis = -1;
        int best_bin = 0;
        float best_cost = std::numeric_limits<float>::infinity();
        for (int axis = 0; axis < 3; ++axis) {
            if (scale[axis] == 0) continue;
            std::array<float, bin_count> right_cost{};
            Bin right;
            for (int i = bin_count - 1; i > 0; --i) {
                right.add(bins[axis][i]);
                right_cost[i] = right.count > 0 ? right.cost() : -1;
            }
            Bin left;
            for (int i = 1; i < bin_count; ++i) {
                left.add(bins[axis][i - 1]);
                if (left.count == 0 || right_cost[i] < 0) continue;
                // Thin slices cost more, as in Conty Estevez and Kulla's equation (6).
                const float cost = (left.cost() + right_cost[i]) * longest / size[axis];
                if (cost < best_cost) {
                    best_cost = cost;
                    best_axis = axis;
                    best_bin = i;
                }
            }
        }
        if (best_axis < 0) {
            return split_directions(begin, end);
        }
        const auto first = references_.begin();
        const auto middle = std::partition(
            first + static_cast<std::ptrdiff_t>(begin), first + static_cast<std::ptrdiff_t>(end),
            [&](const Reference& r) { return bin_of(r, best_axis) < best_bin; });
        return static_cast<std::size_t>(middle - first);
    }

    // Of lights at one place those without an axis go to the left, otherwise the half with the
    // smaller component of the axis, that which differs most.
    std::size_t split_directions(std::size_t begin, std::size_t end) {
        const std::size_t half = begin + (end - begin) / 2;
        const auto direction_of = [](const Reference& r) {
            return r.power > 0 ? r.axis / r.power : glm::vec3(0);
        };
        const auto at = [&](std::size_t i) {
            return references_.begin() + static_cast<std::ptrdiff_t>(i);
        };
        const auto middle = std::stable_partition(
            at(begin), at(end), [](const Reference& r) { return r.axis == glm::vec3(0); });
        if (middle != at(begin) && middle != at(end))
            return static_cast<std::size_t>(middle - references_.begin());
        Bounds bounds;
        for (std::size_t i = begin; i < end; ++i) bounds.add(direction_of(references_[i]));
        const glm::vec3 size = bounds.upper - bounds.lower;
        int axis = size.x >= size.y ? 0 : 1;
        if (size.z > size[axis]) axis = 2;
        if (!(size[axis] > 0)) return half;
        std::nth_element(at(begin), at(half), at(end), [&](const Reference& a, const Reference& b) {
            return direction_of(a)[axis] < direction_of(b)[axis];
        });
        return half;
    }

    const std::vector<Light>& lights_;
    LightTree& tree_;
    std::vector<Reference> references_;
    std::size_t first_light_ = 0;
    std::size_t first_split_ = 0;
    int task_depth_ = 0;
};

}  // namespace

LightTree build_light_tree(const std::vector<Light>& lights, const std::vector<bool>& seen) {
    std::vector<Reference> directional;
    std::vector<Reference> finite;
    for (std::size_t i = 0; i < lights.size(); ++i) {
        const Light& light = lights[i];
        const LightNode leaf = leaf_of(light, 0);
        const Reference r{glm::vec3(leaf.centre), light.emission.w,
                          light.emission.w * glm::vec3(leaf.axis), static_cast<std::uint32_t>(i)};
        (NODE_IS_INFINITE(leaf) ? directional : finite).push_back(r);
    }
    LightTree tree;
    Builder builder(lights, tree);
    for (std::vector<Reference>* references : {&directional, &finite}) {
        const auto hidden = std::stable_partition(
            references->begin(), references->end(),
            [&](const Reference& r) { return !seen.empty() && seen[r.light]; });
        const auto count = static_cast<std::size_t>(hidden - references->begin());
        builder.build(std::move(*references), count);
    }
    return tree;
}

}  // namespace manylight

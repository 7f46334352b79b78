// SPDX-License-Identifier: MIT
#include "samplers/octree/build_octree.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/glm.hpp>
#include <limits>

#include "lights/lights.hpp"

namespace manylight {
namespace {

// How far before a virtual light shadow rays end: this many times as far as before its lights,
// whose positions are rounded once and not twice.
constexpr float virtual_offset = 2;

// A light as the octree takes it.
struct Item {
    glm::dvec3 position;  // see Extent
    glm::dvec3 axis;      // unit, of the emission, or 0
    glm::dvec3 intensity;
    double weight;  // luminance of the intensity
    std::array<glm::dvec3, 4> corners;
    uint light;
    uint emits;
    float range_inverse;  // 1 / range^2
    float inner, outer;   // of a spot: 1 - cosine
    float offset;
};

double luminance(const glm::dvec3& rgb) { return 0.2126 * rgb.r + 0.7152 * rgb.g + 0.0722 * rgb.b; }

Item item_of(const Light& light, uint index) {
    const Extent<double> extent = extent_of<double>(light);
    Item item{};
    item.light = index;
    item.position = extent.centre;
    item.corners = extent.corners;
    item.intensity = glm::dvec3(light.emission) * extent.area;
    if (light_has(light, TRAIT_RANGE) && light.axis.w > 0)
        item.range_inverse = 1 / (light.axis.w * light.axis.w);
    if (light_has(light, TRAIT_EVEN)) item.emits = EMITS_EVENLY;
    if (light_has(light, TRAIT_CONE)) {
        item.emits = EMITS_CONE;
        item.axis = glm::dvec3(light.axis);
        item.inner = light.edge.y - 1 / light.edge.x;
        item.outer = light.edge.y;
    }
    if (light_has(light, TRAIT_COSINE)) {
        item.emits = shines_to_both_sides(light) ? EMITS_BOTH : EMITS_FRONT;
        item.axis = glm::dvec3(light.axis);
        item.offset = light.edge.w;
    }
    if (light_has(light, TRAIT_AREA)) {
        item.emits |= EMITS_AREA;
        const glm::dvec3 normal = area_normal(light);
        const double area = glm::length(normal);
        item.axis = area > 0 ? normal / area : glm::dvec3(0);
    }
    item.weight = luminance(item.intensity);
    return item;
}

double angle_between(const glm::dvec3& a, const glm::dvec3& b) {
    return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
}

// Not less than a number of double precision.
float rounded_up(double value) {
    return std::nextafter(static_cast<float>(value), std::numeric_limits<float>::infinity());
}

class Builder {
  public:
    explicit Builder(std::vector<Item> items) : items_(std::move(items)) {}

    // Appends the tree of some lights.
    void build(std::size_t begin, std::size_t end) {
        const std::size_t index = nodes_.size();
        nodes_.emplace_back();
        if (end - begin > 1)
            for (const auto& [first, last] : parts(begin, end)) build(first, last);
        nodes_[index] = join(begin, end);
        nodes_[index].next = static_cast<uint>(nodes_.size());
    }

    [[nodiscard]] std::vector<OctreeNode> take() { return std::move(nodes_); }

  private:
    using Range = std::pair<std::size_t, std::size_t>;

    std::vector<Range> parts(std::size_t begin, std::size_t end) {
        for (const auto key : {&Item::position, &Item::axis}) {
            std::vector<Range> octants = split(begin, end, key);
            if (octants.size() > 1) return octants;
        }
        std::vector<Range> eighths;
        for (std::size_t i = 0; i < 8; ++i) {
            const std::size_t first = begin + i * (end - begin) / 8;
            const std::size_t last = begin + (i + 1) * (end - begin) / 8;
            if (first < last) eighths.emplace_back(first, last);
        }
        return eighths;
    }

    // Sorts lights into the octants of their bounds; returns those that are not empty.
    std::vector<Range> split(std::size_t begin, std::size_t end, glm::dvec3 Item::*key) {
        glm::dvec3 lower(std::numeric_limits<double>::infinity());
        glm::dvec3 upper = -lower;
        for (std::size_t i = begin; i < end; ++i) {
            lower = glm::min(lower, items_[i].*key);
            upper = glm::max(upper, items_[i].*key);
        }
        const glm::dvec3 size = upper - lower;
        const double longest = std::max({size.x, size.y, size.z});
        if (!(longest > 0)) return {};
        const glm::dvec3 middle = lower + size / 2.0;
        const auto octant = [&](const Item& item) {
            unsigned code = 0;
            for (int axis = 0; axis < 3; ++axis)
                if (2 * size[axis] >= longest && (item.*key)[axis] > middle[axis])
                    code |= 1u << axis;
            return code;
        };
        std::array<std::vector<Item>, 8> sorted;
        for (std::size_t i = begin; i < end; ++i) sorted[octant(items_[i])].push_back(items_[i]);
        std::vector<Range> ranges;
        for (const std::vector<Item>& part : sorted) {
            if (part.empty()) continue;
            std::ranges::copy(part, items_.begin() + static_cast<std::ptrdiff_t>(begin));
            ranges.emplace_back(begin, begin + part.size());
            begin += part.size();
        }
        return ranges;
    }

    // All but `next`.
    [[nodiscard]] OctreeNode join(std::size_t begin, std::size_t end) const {
        OctreeNode node{};
        glm::dvec3 intensity(0);
        glm::dvec3 position(0);
        glm::dvec3 axis(0);
        glm::dvec3 all_axes(0);
        double sum = 0;
        double evenly = 0;
        node.inner = 2;
        node.far_range = std::numeric_limits<float>::infinity();
        for (std::size_t i = begin; i < end; ++i) {
            const Item& item = items_[i];
            intensity += item.intensity;
            position += item.weight * item.position;
            sum += item.weight;
            all_axes += item.axis;
            if ((item.emits & (EMITS_EVENLY | EMITS_CONE)) != 0)
                evenly += item.weight;
            else
                axis += item.weight * item.axis;
            node.emits |= item.emits;
            node.near_range = std::max(node.near_range, item.range_inverse);
            node.far_range = std::min(node.far_range, item.range_inverse);
            node.intensity.w = std::max(node.intensity.w, virtual_offset * item.offset);
            if ((item.emits & EMITS_CONE) == 0) continue;
            node.inner = std::min(node.inner, item.inner);
            node.outer = std::max(node.outer, item.outer);
        }
        node.light = items_[begin].light;
        node.count = static_cast<uint>(end - begin);
        node.centre = float4(glm::vec3(position / sum), 0);
        node.axis = float4(glm::vec3(axis / sum), static_cast<float>(evenly / sum));
        node.intensity = float4(glm::vec3(intensity), node.intensity.w);
        node.centre.w = radius_about(glm::dvec3(node.centre), begin, end);
        node.cone = cone_about(all_axes, begin, end);
        return node;
    }

    [[nodiscard]] float radius_about(const glm::dvec3& centre, std::size_t begin,
                                     std::size_t end) const {
        double radius = 0;
        for (std::size_t i = begin; i < end; ++i)
            for (const glm::dvec3& corner : items_[i].corners)
                radius = std::max(radius, glm::length(corner - centre));
        return radius > 0 ? rounded_up(radius) : 0;
    }

    // The axis, rounded, and 1 - cosine of the largest angle to it, wider by what rounding does.
    [[nodiscard]] float4 cone_about(const glm::dvec3& sum, std::size_t begin,
                                    std::size_t end) const {
        const float4 everything(0, 0, 1, 2);
        if (glm::length(sum) < 1e-6 * static_cast<double>(end - begin)) return everything;
        const glm::vec3 axis(glm::normalize(sum));
        double widest = 0;
        for (std::size_t i = begin; i < end; ++i)
            if (items_[i].axis != glm::dvec3(0))
                widest = std::max(widest, angle_between(glm::dvec3(axis), items_[i].axis));
        const double half_sine = std::sin((widest + OCTREE_MARGIN) / 2);
        return {axis, std::min(rounded_up(2 * half_sine * half_sine), 2.f)};
    }

    std::vector<Item> items_;
    std::vector<OctreeNode> nodes_;
};

}  // namespace

std::vector<OctreeNode> build_octree(const std::vector<Light>& lights) {
    std::vector<Item> items;
    std::vector<Item> infinite;
    for (std::size_t i = 0; i < lights.size(); ++i) {
        const Item item = item_of(lights[i], static_cast<uint>(i));
        if (!(item.weight > 0)) continue;
        (light_has(lights[i], TRAIT_INFINITE) ? infinite : items).push_back(item);
    }
    if (items.empty() && infinite.empty() && !lights.empty()) {
        infinite.push_back(item_of(lights[0], 0));
        infinite[0].weight = 1;
    }
    const std::size_t leaves = infinite.size();
    infinite.insert(infinite.end(), items.begin(), items.end());
    Builder builder(std::move(infinite));
    for (std::size_t i = 0; i < leaves; ++i) builder.build(i, i + 1);
    if (!items.empty()) builder.build(leaves, leaves + items.size());
    return builder.take();
}

}  // namespace manylight

// SPDX-License-Identifier: MIT
#include "bvh/binary.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <future>
#include <thread>

namespace manylight {
namespace {

constexpr int bin_count = 32;
constexpr int few_bins = 8;                // for no more triangles than a leaf holds
constexpr float splitting_cost = 1.2f;     // of one more child, as a factor; measured
constexpr int deepest_sah = 48;            // below, halves: bounds the depth whatever the input
constexpr std::size_t task_size = 32'768;  // triangles worth a thread of their own

struct Reference {
    Bounds bounds;
    glm::vec3 centre;
    std::uint32_t triangle;
};

float half_area(const Bounds& b) {
    const glm::vec3 d = b.upper - b.lower;
    return b.empty() ? 0 : d.x * d.y + d.y * d.z + d.z * d.x;
}

void add(Bounds& into, const Bounds& b) {
    into.lower = glm::min(into.lower, b.lower);
    into.upper = glm::max(into.upper, b.upper);
}

struct Bin {
    Bounds bounds;
    std::uint32_t count = 0;
};

struct Split {
    int axis = -1;  // -1: none
    int bin = 0;    // the first bin of the right side
    float cost = std::numeric_limits<float>::infinity();
};

// Maps centres to bins along each axis.
template <int Bins>
struct Binning {
    glm::vec3 lower, scale;
    explicit Binning(const Bounds& centres) : lower(centres.lower), scale(0) {
        for (int axis = 0; axis < 3; ++axis) {
            const float width = centres.upper[axis] - lower[axis];
            if (width > 0) scale[axis] = Bins * 0.9999f / width;
            if (!std::isfinite(scale[axis])) scale[axis] = 0;
        }
    }
    [[nodiscard]] int bin(const Reference& r, int axis) const {
        return static_cast<int>((r.centre[axis] - lower[axis]) * scale[axis]);
    }
};

class Builder {
  public:
    Builder(std::vector<Reference> references, unsigned leaf_size)
        : references_(std::move(references)), leaf_size_(leaf_size) {
        bvh_.nodes.resize(2 * references_.size() - 1);
    }

    BinaryBvh build() {
        const unsigned threads = std::max(std::thread::hardware_concurrency(), 1u);
        while ((1u << task_depth_) < 4 * threads) ++task_depth_;
        build_node(0, 0, references_.size(), 0);
        bvh_.nodes.resize(next_node_);
        bvh_.triangles.reserve(references_.size());
        for (const Reference& r : references_) bvh_.triangles.push_back(r.triangle);
        return std::move(bvh_);
    }

  private:
    void build_node(std::uint32_t index, std::size_t begin, std::size_t end, int depth) {
        BinaryNode& node = bvh_.nodes[index];
        Bounds centres;
        for (std::size_t i = begin; i < end; ++i) {
            add(node.bounds, references_[i].bounds);
            centres.add(references_[i].centre);
        }
        const std::size_t count = end - begin;
        const std::size_t middle = count <= leaf_size_
                                       ? split_leaf(begin, end, node.bounds, centres)
                                       : split_node(begin, end, centres, depth);
        if (middle == end) {
            node.first = static_cast<std::uint32_t>(begin);
            node.count = static_cast<std::uint32_t>(count);
            return;
        }
        const std::uint32_t left = next_node_.fetch_add(2);
        node.first = left;
        node.right = left + 1;
        const bool fork = count >= task_size && depth < task_depth_;
        const auto right = [=, this] { build_node(left + 1, middle, end, depth + 1); };
        std::future<void> task;
        if (fork) task = std::async(std::launch::async, right);
        build_node(left, begin, middle, depth + 1);
        fork ? task.get() : right();
    }

    // Puts the left side's references first and returns where the right side's begin; `end` if one
    // block is better than two: if those would not be met so much less often, as the walls of a
    // room are, in whose middle there is nothing. Only the longest axis is tried.
    std::size_t split_leaf(std::size_t begin, std::size_t end, const Bounds& bounds,
                           const Bounds& centres) {
        const glm::vec3 extent = centres.upper - centres.lower;
        const int axis =
            extent.x > extent.y ? (extent.x > extent.z ? 0 : 2) : (extent.y > extent.z ? 1 : 2);
        const Binning<few_bins> binning(centres);
        const Split split = find_split(begin, end, binning, axis, axis + 1);
        if (split.axis < 0 || split.cost * splitting_cost >= half_area(bounds)) return end;
        return partition(begin, end, binning, split);
    }

    // The same for references that need more than one block.
    std::size_t split_node(std::size_t begin, std::size_t end, const Bounds& centres, int depth) {
        const Binning<bin_count> binning(centres);
        const Split split = depth < deepest_sah ? find_split(begin, end, binning, 0, 3) : Split{};
        if (split.axis < 0) return begin + (end - begin) / 2;  // coincident centres: any halves do
        return partition(begin, end, binning, split);
    }

    template <int Bins>
    std::size_t partition(std::size_t begin, std::size_t end, const Binning<Bins>& binning,
                          const Split& split) {
        const auto first = references_.begin();
        const auto middle = std::partition(
            first + static_cast<std::ptrdiff_t>(begin), first + static_cast<std::ptrdiff_t>(end),
            [&](const Reference& r) { return binning.bin(r, split.axis) < split.bin; });
        return static_cast<std::size_t>(middle - first);
    }

    template <int Bins>
    Split find_split(std::size_t begin, std::size_t end, const Binning<Bins>& binning,
                     int first_axis, int end_axis) const {
        std::array<std::array<Bin, Bins>, 3> bins;
        for (std::size_t i = begin; i < end; ++i)
            for (int axis = first_axis; axis < end_axis; ++axis) {
                Bin& bin = bins[axis][binning.bin(references_[i], axis)];
                add(bin.bounds, references_[i].bounds);
                ++bin.count;
            }
        Split best;
        for (int axis = first_axis; axis < end_axis; ++axis)
            if (binning.scale[axis] > 0) sweep(bins[axis], axis, best);
        return best;
    }

    // The cost of a side is its area times the blocks that its triangles fill.
    [[nodiscard]] float cost(const Bounds& bounds, std::uint32_t count) const {
        return half_area(bounds) * static_cast<float>((count + leaf_size_ - 1) / leaf_size_);
    }

    template <std::size_t Bins>
    void sweep(const std::array<Bin, Bins>& bins, int axis, Split& best) const {
        std::array<float, Bins> right_cost{};
        Bin right;
        for (int i = Bins - 1; i > 0; --i) {
            add(right.bounds, bins[i].bounds);
            right.count += bins[i].count;
            right_cost[i] = right.count == 0 ? std::numeric_limits<float>::infinity()
                                             : cost(right.bounds, right.count);
        }
        Bin left;
        for (int i = 1; i < static_cast<int>(Bins); ++i) {
            add(left.bounds, bins[i - 1].bounds);
            left.count += bins[i - 1].count;
            if (left.count == 0) continue;
            const float total = cost(left.bounds, left.count) + right_cost[i];
            if (total < best.cost) best = {axis, i, total};
        }
    }

    std::vector<Reference> references_;
    unsigned leaf_size_;
    int task_depth_ = 0;
    BinaryBvh bvh_;
    std::atomic<std::uint32_t> next_node_ = 1;
};

}  // namespace

BinaryBvh build_binary_bvh(const Scene& scene, unsigned leaf_size) {
    std::vector<Reference> references;
    references.reserve(scene.triangle_count());
    for (std::size_t t = 0; t < scene.triangle_count(); ++t) {
        glm::vec3 v[3];
        Reference r;
        for (int k = 0; k < 3; ++k) r.bounds.add(v[k] = scene.vertices[scene.indices[3 * t + k]]);
        if (glm::cross(v[1] - v[0], v[2] - v[0]) == glm::vec3(0)) continue;
        r.centre = r.bounds.lower * 0.5f + r.bounds.upper * 0.5f;
        r.triangle = static_cast<std::uint32_t>(t);
        references.push_back(r);
    }
    if (references.empty()) return {};
    return Builder(std::move(references), leaf_size).build();
}

}  // namespace manylight

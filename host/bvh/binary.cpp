// SPDX-License-Identifier: MIT
#include "bvh/binary.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <future>
#include <memory>
#include <thread>

namespace manylight {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();
constexpr int bin_count = 32;
constexpr int few_bins = 8;                // for no more triangles than a leaf holds
constexpr float splitting_cost = 1.2f;     // of one more child, as a factor; measured
constexpr int deepest_sah = 48;            // below, halves: bounds the depth whatever the input
constexpr std::size_t task_size = 32'768;  // triangles worth a thread of their own

// Bounds whose coordinates fill a vector register each; the fourth is unused. Selections are
// written out, since compilers make one instruction of four of them.
struct Box {
    std::array<float, 4> lower{infinity, infinity, infinity, infinity};
    std::array<float, 4> upper{-infinity, -infinity, -infinity, -infinity};

    void add(const std::array<float, 4>& low, const std::array<float, 4>& high) {
        for (int k = 0; k < 4; ++k) lower[k] = low[k] < lower[k] ? low[k] : lower[k];
        for (int k = 0; k < 4; ++k) upper[k] = high[k] > upper[k] ? high[k] : upper[k];
    }
    void add(const Box& b) { add(b.lower, b.upper); }
};

struct Reference {
    Box box;
    std::array<float, 4> centre;
    std::uint32_t triangle;
};

float half_area(const Box& b) {
    if (b.lower[0] > b.upper[0]) return 0;
    const float x = b.upper[0] - b.lower[0];
    const float y = b.upper[1] - b.lower[1];
    const float z = b.upper[2] - b.lower[2];
    return x * y + y * z + z * x;
}

Bounds to_bounds(const Box& b) {
    return {{b.lower[0], b.lower[1], b.lower[2]}, {b.upper[0], b.upper[1], b.upper[2]}};
}

struct Bin {
    Box bounds;
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
    std::array<float, 4> lower, scale{};
    explicit Binning(const Box& centres) : lower(centres.lower) {
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
    Builder(std::vector<Reference> references, unsigned leaf_size,
            const std::function<void(double)>& report)
        : references_(std::move(references)), leaf_size_(leaf_size), report_(report) {
        most_nodes_ = 2 * references_.size() - 1;
        nodes_ = std::allocator<BinaryNode>().allocate(most_nodes_);
    }
    ~Builder() { std::allocator<BinaryNode>().deallocate(nodes_, most_nodes_); }
    Builder(const Builder&) = delete;
    Builder& operator=(const Builder&) = delete;

    BinaryBvh build() {
        const unsigned threads = std::max(std::thread::hardware_concurrency(), 1u);
        while ((1u << task_depth_) < 4 * threads) ++task_depth_;
        build_node(0, 0, references_.size(), 0);
        BinaryBvh bvh;
        bvh.nodes.assign(nodes_, nodes_ + next_node_);
        bvh.triangles.reserve(references_.size());
        for (const Reference& r : references_) bvh.triangles.push_back(r.triangle);
        return bvh;
    }

  private:
    void build_node(std::uint32_t index, std::size_t begin, std::size_t end, int depth) {
        BinaryNode& node = *std::construct_at(nodes_ + index);
        Box box;
        Box centres;
        for (std::size_t i = begin; i < end; ++i) {
            box.add(references_[i].box);
            centres.add(references_[i].centre, references_[i].centre);
        }
        node.bounds = to_bounds(box);
        const std::size_t count = end - begin;
        const std::size_t middle = count <= leaf_size_ ? split_leaf(begin, end, box, centres)
                                                       : split_node(begin, end, centres, depth);
        if (middle == end) {
            node.first = static_cast<std::uint32_t>(begin);
            node.count = static_cast<std::uint32_t>(count);
            note_done(count);
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

    void note_done(std::size_t count) {
        const std::size_t done = done_.fetch_add(count) + count;
        if (!report_ || std::this_thread::get_id() != thread_) return;
        if (done - reported_ < references_.size() / 100) return;
        reported_ = done;
        report_(static_cast<double>(done) / static_cast<double>(references_.size()));
    }

    // Puts the left side's references first and returns where the right side's begin; `end` if one
    // block is better than two: if those would not be met so much less often, as the walls of a
    // room are, in whose middle there is nothing. Only the longest axis is tried.
    std::size_t split_leaf(std::size_t begin, std::size_t end, const Box& bounds,
                           const Box& centres) {
        int axis = 0;
        for (int k = 1; k < 3; ++k)
            if (centres.upper[k] - centres.lower[k] > centres.upper[axis] - centres.lower[axis])
                axis = k;
        const Binning<few_bins> binning(centres);
        const Split split = find_split(begin, end, binning, axis, axis + 1);
        if (split.axis < 0 || split.cost * splitting_cost >= half_area(bounds)) return end;
        return partition(begin, end, binning, split);
    }

    // The same for references that need more than one block.
    std::size_t split_node(std::size_t begin, std::size_t end, const Box& centres, int depth) {
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
                bin.bounds.add(references_[i].box);
                ++bin.count;
            }
        Split best;
        for (int axis = first_axis; axis < end_axis; ++axis)
            if (binning.scale[axis] > 0) sweep(bins[axis], axis, best);
        return best;
    }

    // The cost of a side is its area times the blocks that its triangles fill.
    [[nodiscard]] float cost(const Box& bounds, std::uint32_t count) const {
        return half_area(bounds) * static_cast<float>((count + leaf_size_ - 1) / leaf_size_);
    }

    template <std::size_t Bins>
    void sweep(const std::array<Bin, Bins>& bins, int axis, Split& best) const {
        std::array<float, Bins> right_cost{};
        Bin right;
        for (int i = Bins - 1; i > 0; --i) {
            right.bounds.add(bins[i].bounds);
            right.count += bins[i].count;
            right_cost[i] = right.count == 0 ? std::numeric_limits<float>::infinity()
                                             : cost(right.bounds, right.count);
        }
        Bin left;
        for (int i = 1; i < static_cast<int>(Bins); ++i) {
            left.bounds.add(bins[i - 1].bounds);
            left.count += bins[i - 1].count;
            if (left.count == 0) continue;
            const float total = cost(left.bounds, left.count) + right_cost[i];
            if (total < best.cost) best = {axis, i, total};
        }
    }

    std::vector<Reference> references_;
    unsigned leaf_size_;
    int task_depth_ = 0;
    std::size_t most_nodes_;
    BinaryNode* nodes_;  // [most_nodes_]; far fewer are made, and the others' memory is not touched
    std::atomic<std::uint32_t> next_node_ = 1;
    const std::function<void(double)>& report_;
    std::thread::id thread_ = std::this_thread::get_id();
    std::atomic<std::size_t> done_ = 0;  // references in leaves
    std::size_t reported_ = 0;
};

BinaryBvh build(std::vector<Reference> references, unsigned leaf_size,
                const std::function<void(double)>& report) {
    if (references.empty()) return {};
    for (Reference& r : references)
        for (int k = 0; k < 4; ++k) r.centre[k] = r.box.lower[k] * 0.5f + r.box.upper[k] * 0.5f;
    return Builder(std::move(references), leaf_size, report).build();
}

}  // namespace

BinaryBvh build_binary_bvh(const Scene& scene, std::size_t first, std::size_t count,
                           unsigned leaf_size, const std::function<void(double)>& report) {
    std::vector<Reference> references;
    references.reserve(count);
    for (std::size_t t = first; t < first + count; ++t) {
        glm::vec3 v[3];
        Reference r;
        for (int k = 0; k < 3; ++k) {
            v[k] = scene.vertices[scene.indices[3 * t + k]];
            r.box.add({v[k].x, v[k].y, v[k].z, 0}, {v[k].x, v[k].y, v[k].z, 0});
        }
        if (glm::cross(v[1] - v[0], v[2] - v[0]) == glm::vec3(0)) continue;
        r.triangle = static_cast<std::uint32_t>(t);
        references.push_back(r);
    }
    return build(std::move(references), leaf_size, report);
}

BinaryBvh build_binary_bvh(std::span<const Bounds> boxes) {
    std::vector<Reference> references;
    for (std::size_t i = 0; i < boxes.size(); ++i) {
        const glm::vec3& low = boxes[i].lower;
        const glm::vec3& high = boxes[i].upper;
        Reference r;
        r.box.add({low.x, low.y, low.z, 0}, {high.x, high.y, high.z, 0});
        r.triangle = static_cast<std::uint32_t>(i);
        references.push_back(r);
    }
    return build(std::move(references), 1, {});
}

}  // namespace manylight

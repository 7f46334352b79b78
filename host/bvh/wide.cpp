// SPDX-License-Identifier: MIT
#include "bvh/wide.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#define GLM_ENABLE_EXPERIMENTAL
#include <glm/gtx/component_wise.hpp>

namespace manylight {
namespace {

// The slab test computes p * inverse + bias, of which each part is rounded, as is the inverse (2.5
// units in the last place in OpenCL): a plane is off by at most 4 units of the largest coordinate,
// and two planes are compared.
constexpr float padding_scale = 8 * std::numeric_limits<float>::epsilon();

constexpr std::size_t block_rows = 13;

float half_area(const Bounds& b) {
    const glm::vec3 d = b.upper - b.lower;
    return d.x * d.y + d.y * d.z + d.z * d.x;
}

// A node's child as an int, and the entries of a traversal's stack that it needs.
struct Child {
    int child;
    unsigned stack;
};

class Collapser {
  public:
    using Leaf = std::function<Child(const BinaryNode&)>;

    Collapser(const BinaryBvh& binary, WideBvh& wide, float padding, Leaf leaf)
        : binary_(binary), wide_(wide), padding_(padding), leaf_(std::move(leaf)) {}

    // Makes a wide node of a binary one.
    Child collapse(std::uint32_t root) {
        const std::vector<std::uint32_t> children = gather(root);
        const int index = static_cast<int>(wide_.nodes.size() / (7 * wide_.width));
        wide_.nodes.resize(wide_.nodes.size() + 7 * wide_.width);
        unsigned stack = static_cast<unsigned>(children.size());
        for (unsigned lane = 0; lane < wide_.width; ++lane) {
            Bounds bounds;   // inverted where the lane is empty
            int child = -1;  // block 0: harmless should a ray of NaNs get there
            if (lane < children.size()) {
                const BinaryNode& node = binary_.nodes[children[lane]];
                bounds = node.bounds;
                bounds.lower -= padding_;
                bounds.upper += padding_;
                const Child below = node.count > 0 ? leaf_(node) : collapse(children[lane]);
                child = below.child;
                stack = std::max(stack, static_cast<unsigned>(children.size()) - 1 + below.stack);
            }
            float* lanes =
                wide_.nodes.data() + static_cast<std::size_t>(index) * 7 * wide_.width + lane;
            for (int axis = 0; axis < 3; ++axis) {
                lanes[axis * wide_.width] = bounds.lower[axis];
                lanes[(3 + axis) * wide_.width] = bounds.upper[axis];
            }
            lanes[6 * wide_.width] = std::bit_cast<float>(child);
        }
        return {index, stack};
    }

  private:
    // Up to `width` nodes below `root`: the inner node with the largest area is opened first.
    std::vector<std::uint32_t> gather(std::uint32_t root) const {
        std::vector<std::uint32_t> nodes = {root};
        while (nodes.size() < wide_.width) {
            auto largest = nodes.end();
            for (auto it = nodes.begin(); it != nodes.end(); ++it)
                if (binary_.nodes[*it].count == 0 &&
                    (largest == nodes.end() || half_area(binary_.nodes[*it].bounds) >
                                                   half_area(binary_.nodes[*largest].bounds)))
                    largest = it;
            if (largest == nodes.end()) break;
            const BinaryNode& opened = binary_.nodes[*largest];
            *largest = opened.first;
            nodes.push_back(opened.right);
        }
        return nodes;
    }

    const BinaryBvh& binary_;
    WideBvh& wide_;
    float padding_;
    Leaf leaf_;
};

// A block of a leaf's triangles.
Child make_block(const Scene& scene, const BinaryBvh& binary, const BinaryNode& leaf,
                 WideBvh& wide) {
    const std::size_t index = wide.blocks.size() / (block_rows * wide.block);
    wide.blocks.resize(wide.blocks.size() + block_rows * wide.block, 0.0f);
    float* block = wide.blocks.data() + index * block_rows * wide.block;
    for (unsigned lane = 0; lane < leaf.count; ++lane) {
        const std::uint32_t triangle = binary.triangles[leaf.first + lane];
        const std::uint32_t* corner = scene.indices.data() + 3 * std::size_t{triangle};
        const glm::vec3 first = scene.vertices[corner[0]];
        const glm::vec3 rows[] = {first, scene.vertices[corner[1]] - first,
                                  scene.vertices[corner[2]] - first};
        for (int row = 0; row < 9; ++row) block[row * wide.block + lane] = rows[row / 3][row % 3];
        const glm::vec3 edges[] = {rows[1], rows[2], rows[2] - rows[1]};
        for (int edge = 0; edge < 3; ++edge)
            block[(10 + edge) * wide.block + lane] = glm::compMax(glm::abs(edges[edge]));
        block[9 * wide.block + lane] = std::bit_cast<float>(triangle);
    }
    return {~static_cast<int>(index << 4 | (leaf.count - 1)), 1};
}

// A node whose lanes are all empty, and a block of none.
Child make_nothing(WideBvh& wide) {
    wide.nodes.assign(7 * wide.width, std::bit_cast<float>(-1));
    std::fill_n(wide.nodes.begin(), 3 * wide.width, std::numeric_limits<float>::infinity());
    std::fill_n(wide.nodes.begin() + 3 * wide.width, 3 * wide.width,
                -std::numeric_limits<float>::infinity());
    wide.blocks.assign(block_rows * wide.block, 0.0f);
    return {0, 1};
}

// The largest coordinate, in the frame of an instance's mesh, of points within `reach` of the
// world's origin.
float reach_in_mesh(const Instance& in, float reach) {
    float largest = 0;
    for (const float4& row : in.to_object) {
        float sum = 0;
        for (int k = 0; k < 3; ++k) sum += std::abs(row[k]) * (reach + std::abs(in.to_world[k].w));
        largest = std::max(largest, sum);
    }
    return largest;
}

// Builds what a scene is made of: [0] what stands in the world, and each shared mesh.
std::vector<BinaryBvh> build_parts(const Scene& scene, unsigned block,
                                   const std::function<void(double)>& report) {
    std::vector<std::pair<std::size_t, std::size_t>> runs = {{0, scene.own_triangle_count()}};
    for (const SharedMesh& mesh : scene.shared_meshes)
        runs.emplace_back(mesh.first_triangle, mesh.triangle_count);
    std::vector<BinaryBvh> parts;
    const auto all = static_cast<double>(std::max<std::size_t>(scene.triangle_count(), 1));
    for (const auto& [first, count] : runs)
        parts.push_back(build_binary_bvh(scene, first, count, block, [&](double share) {
            if (report)
                report((static_cast<double>(first) + share * static_cast<double>(count)) / all);
        }));
    return parts;
}

class WideBuilder {
  public:
    WideBuilder(const Scene& scene, float reach, std::vector<BinaryBvh> parts, WideBvh& wide)
        : scene_(scene), reach_(reach), parts_(std::move(parts)), wide_(wide) {
        std::size_t leaves = 0;
        for (const BinaryBvh& part : parts_)
            leaves += static_cast<std::size_t>(std::ranges::count_if(
                part.nodes, [](const BinaryNode& node) { return node.count > 0; }));
        wide.blocks.reserve(leaves * block_rows * wide.block);
        wide.nodes.reserve(leaves * 7);  // about a node per `width` leaves
    }

    // Returns the entries of a stack that a traversal needs.
    unsigned build() {
        if (scene_.instances.empty())
            return (parts_[0].nodes.empty() ? make_nothing(wide_) : add_world()).stack;
        wide_.instances = scene_.instances;
        std::vector<Bounds> boxes;
        std::vector<int> names;  // [box] the instance, or -1: what stands in the world
        if (!parts_[0].nodes.empty()) {
            boxes.push_back(parts_[0].nodes[0].bounds);
            names.push_back(-1);
        }
        for (std::size_t i = 0; i < scene_.instances.size(); ++i) {
            const Instance& in = scene_.instances[i];
            const BinaryBvh& mesh = parts_[1 + in.mesh];
            if (mesh.nodes.empty()) continue;
            Bounds& box = boxes.emplace_back();
            for (int k = 0; k < 8; ++k) box.add(point_to_world(in, mesh.nodes[0].bounds.corner(k)));
            names.push_back(static_cast<int>(i));
        }
        if (boxes.empty()) return make_nothing(wide_).stack;
        const unsigned above = add_top(boxes, names);
        return above + add_meshes();
    }

  private:
    Child add_world() {
        const auto block = [&](const BinaryNode& leaf) {
            return make_block(scene_, parts_[0], leaf, wide_);
        };
        return Collapser(parts_[0], wide_, padding_scale * reach_, block).collapse(0);
    }

    // Below a root of its own. Each leaf has one block in `blocks`, however often it is added.
    Child add_mesh(const BinaryBvh& binary, float padding, std::vector<Child>& blocks) {
        blocks.resize(binary.nodes.size(), {0, 0});
        const auto block_of = [&](const BinaryNode& leaf) {
            Child& block = blocks[static_cast<std::size_t>(&leaf - binary.nodes.data())];
            if (block.stack == 0) block = make_block(scene_, binary, leaf, wide_);
            return block;
        };
        return Collapser(binary, wide_, padding, block_of).collapse(0);
    }

    // Returns the entries of a stack that a traversal of any needs. A mesh whose instances are
    // large and small has several roots: a small one's rounding, in the mesh's frame, is large, and
    // boxes padded for it would be of no use to the others.
    unsigned add_meshes() {
        constexpr float alike = 16;
        std::vector<std::vector<std::pair<float, Instance*>>> placed(scene_.shared_meshes.size());
        for (Instance& in : wide_.instances)
            placed[in.mesh].emplace_back(2 * reach_in_mesh(in, reach_), &in);
        unsigned deepest = 0;
        for (std::size_t mesh = 0; mesh < placed.size(); ++mesh) {
            const BinaryBvh& binary = parts_[1 + mesh];
            if (binary.nodes.empty()) continue;
            std::ranges::stable_sort(placed[mesh], {}, &std::pair<float, Instance*>::first);
            std::vector<Child> blocks;
            for (auto first = placed[mesh].begin(); first != placed[mesh].end();) {
                const auto last = std::find_if(first, placed[mesh].end(), [&](const auto& other) {
                    return other.first > alike * first->first;
                });
                const float padding = padding_scale * std::prev(last)->first;
                const Child root = add_mesh(binary, padding, blocks);
                deepest = std::max(deepest, root.stack);
                for (; first != last; ++first) first->second->root = root.child;
            }
        }
        return deepest;
    }

    // Twice the padding: matrices are rounded, too.
    unsigned add_top(const std::vector<Bounds>& boxes, const std::vector<int>& names) {
        const BinaryBvh top = build_binary_bvh(boxes);
        const auto child = [&](const BinaryNode& leaf) {
            const int name = names[top.triangles[leaf.first]];
            return name < 0 ? add_world() : Child{INSTANCE_CHILD + name, 1};
        };
        return Collapser(top, wide_, 2 * padding_scale * reach_, child).collapse(0).stack;
    }

    const Scene& scene_;
    float reach_;
    std::vector<BinaryBvh> parts_;
    WideBvh& wide_;
};

}  // namespace

WideBvh::WideBvh() = default;
WideBvh::WideBvh(WideBvh&&) noexcept = default;
WideBvh& WideBvh::operator=(WideBvh&&) noexcept = default;
WideBvh::~WideBvh() = default;

WideBvh build_wide_bvh(const Scene& scene, unsigned width, unsigned block, float reach,
                       const std::function<void(double)>& report) {
    WideBvh wide;
    wide.width = width;
    wide.block = block;
    std::vector<BinaryBvh> parts = build_parts(scene, block, [&](double share) {
        if (report) report(0.8 * share);
    });
    const unsigned stack = WideBuilder(scene, reach, std::move(parts), wide).build();
    wide.stack = (stack + 31) / 32 * 32;
    return wide;
}

float reach_of(const Scene& scene, const Camera& camera) {
    float reach = glm::compMax(glm::abs(glm::vec3(camera.origin)) +
                               glm::abs(glm::vec3(camera.right)) + glm::abs(glm::vec3(camera.up)));
    const Bounds bounds = scene.bounds();
    if (!bounds.empty())
        reach = std::max(
            {reach, glm::compMax(glm::abs(bounds.lower)), glm::compMax(glm::abs(bounds.upper))});
    return reach;
}

}  // namespace manylight

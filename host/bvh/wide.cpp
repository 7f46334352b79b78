// SPDX-License-Identifier: MIT
#include "bvh/wide.hpp"

#include <algorithm>
#include <bit>
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

class Collapser {
  public:
    Collapser(const Scene& scene, const BinaryBvh& binary, WideBvh& wide, float padding)
        : scene_(scene), binary_(binary), wide_(wide), padding_(padding) {}

    // Makes a wide node of a binary one; returns its index and the stack entries that it needs.
    std::pair<int, unsigned> collapse(std::uint32_t root) {
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
                if (node.count > 0) {
                    child = make_block(node);
                } else {
                    const auto [inner, need] = collapse(children[lane]);
                    child = inner;
                    stack = std::max(stack, static_cast<unsigned>(children.size()) - 1 + need);
                }
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

    int make_block(const BinaryNode& leaf) {
        const std::size_t index = wide_.blocks.size() / (block_rows * wide_.block);
        wide_.blocks.resize(wide_.blocks.size() + block_rows * wide_.block, 0.0f);
        float* block = wide_.blocks.data() + index * block_rows * wide_.block;
        for (unsigned lane = 0; lane < leaf.count; ++lane) {
            const std::uint32_t triangle = binary_.triangles[leaf.first + lane];
            const std::uint32_t* corner = scene_.indices.data() + 3 * std::size_t{triangle};
            const glm::vec3 first = scene_.vertices[corner[0]];
            const glm::vec3 rows[] = {first, scene_.vertices[corner[1]] - first,
                                      scene_.vertices[corner[2]] - first};
            for (int row = 0; row < 9; ++row)
                block[row * wide_.block + lane] = rows[row / 3][row % 3];
            const glm::vec3 edges[] = {rows[1], rows[2], rows[2] - rows[1]};
            for (int edge = 0; edge < 3; ++edge)
                block[(10 + edge) * wide_.block + lane] = glm::compMax(glm::abs(edges[edge]));
            block[9 * wide_.block + lane] = std::bit_cast<float>(triangle);
        }
        return ~static_cast<int>(index << 4 | (leaf.count - 1));
    }

    const Scene& scene_;
    const BinaryBvh& binary_;
    WideBvh& wide_;
    float padding_;
};

}  // namespace

WideBvh build_wide_bvh(const Scene& scene, unsigned width, unsigned block, float reach,
                       const std::function<void(double)>& report) {
    const BinaryBvh binary = build_binary_bvh(
        scene, block, report ? [&](double share) { report(0.8 * share); } : report);
    WideBvh wide;
    wide.width = width;
    wide.block = block;
    unsigned stack = 1;
    if (binary.nodes.empty()) {  // a root whose lanes are all empty, and a block of none
        wide.nodes.assign(7 * width, std::bit_cast<float>(-1));
        std::fill_n(wide.nodes.begin(), 3 * width, std::numeric_limits<float>::infinity());
        std::fill_n(wide.nodes.begin() + 3 * width, 3 * width,
                    -std::numeric_limits<float>::infinity());
        wide.blocks.assign(block_rows * block, 0.0f);
    } else {
        const auto leaves = static_cast<std::size_t>(std::ranges::count_if(
            binary.nodes, [](const BinaryNode& node) { return node.count > 0; }));
        wide.blocks.reserve(leaves * block_rows * block);
        wide.nodes.reserve(leaves * 7);  // about a node per `width` leaves
        stack = Collapser(scene, binary, wide, padding_scale * reach).collapse(0).second;
    }
    wide.stack = (stack + 31) / 32 * 32;
    return wide;
}

float reach_of(const Scene& scene, const Camera& camera) {
    float reach = glm::compMax(glm::abs(glm::vec3(camera.origin)) +
                               glm::abs(glm::vec3(camera.right)) + glm::abs(glm::vec3(camera.up)));
    for (const glm::vec3& vertex : scene.vertices)
        reach = std::max(reach, glm::compMax(glm::abs(vertex)));
    return reach;
}

}  // namespace manylight

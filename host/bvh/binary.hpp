// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "scene/scene.hpp"

namespace manylight {

struct BinaryNode {
    Bounds bounds;
    std::uint32_t first = 0;  // leaf: first of its entries in BinaryBvh::triangles; else left child
    std::uint32_t right = 0;  // inner node: right child
    std::uint32_t count = 0;  // leaf: number of triangles, at least 1; inner node: 0
};

/// A binary bounding volume hierarchy; nodes[0] is the root. Empty if no triangle has an area.
struct BinaryBvh {
    std::vector<BinaryNode> nodes;
    std::vector<std::uint32_t> triangles;  // or boxes
};

/// Builds top-down with the surface area heuristic over 32 bins per axis (Wald, "On fast
/// Construction of SAH-based Bounding Volume Hierarchies", 2007), in parallel, of a scene's
/// triangles from `first` on. Leaves hold at most `leaf_size` of them. Triangles without area are
/// left out: no ray hits them. The result does not depend on the number of threads, but the order
/// of nodes may. `report` gets the share done now and then, on the calling thread.
[[nodiscard]] BinaryBvh build_binary_bvh(const Scene& scene, std::size_t first, std::size_t count,
                                         unsigned leaf_size,
                                         const std::function<void(double)>& report = {});

/// The same of boxes, one in a leaf.
[[nodiscard]] BinaryBvh build_binary_bvh(std::span<const Bounds> boxes);

}  // namespace manylight

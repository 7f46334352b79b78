// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
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
    std::vector<std::uint32_t> triangles;
};

/// Builds top-down with the surface area heuristic over 32 bins per axis (Wald, "On fast
/// Construction of SAH-based Bounding Volume Hierarchies", 2007), in parallel. Leaves hold at most
/// `leaf_size` triangles. Triangles without area are left out: no ray hits them. The result does
/// not depend on the number of threads, but the order of nodes may.
/// `report` gets the share done now and then, on the calling thread.
[[nodiscard]] BinaryBvh build_binary_bvh(const Scene& scene, unsigned leaf_size,
                                         const std::function<void(double)>& report = {});

}  // namespace manylight

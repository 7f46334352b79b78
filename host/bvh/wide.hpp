// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "bvh/binary.hpp"
#include "bvh/page_allocator.hpp"
#include "scene/scene.hpp"

namespace manylight {

/// A BVH for kernels/lib/bvh.h: all children of a node, and all triangles of a leaf's block, lie
/// side by side in vector lanes. Where a scene has instances, it has two levels: what stands in the
/// world and the instances are below node 0, and each mesh that these place is below a root of its
/// own, in its own frame.
struct WideBvh {
    unsigned width = 0;  // children of a node, lanes
    unsigned block = 0;  // triangles of a block, lanes
    unsigned stack = 0;  // entries that a traversal's stack needs, a multiple of 32
    /// nodes[(7 * node + row) * width + lane]: lower x y z, upper x y z, and the child as an int:
    /// a node, INSTANCE_CHILD + an instance, or ~(block index << 4 | triangles - 1).
    std::vector<float, PageAllocator<float>> nodes;
    /// blocks[(13 * index + row) * block + lane]: vertex 0, vertex 1 - vertex 0, vertex 2 - vertex
    /// 0, each x y z; the triangle's index as an int; the largest coordinate of the edges from
    /// vertex 0 to 1, 0 to 2, 1 to 2.
    std::vector<float, PageAllocator<float>> blocks;
    std::vector<Instance> instances;  // the scene's, with their roots

    // Elsewhere: the numbers' allocator keeps a compiler that does not optimise busy with each.
    WideBvh();
    WideBvh(WideBvh&&) noexcept;
    WideBvh& operator=(WideBvh&&) noexcept;
    ~WideBvh();
};

/// The wide BVH of a scene; `width` and `block` are 4, 8 or 16. Boxes are padded so that a ray that
/// starts within `reach` of the origin (the largest absolute coordinate, m) misses none by
/// rounding. `report` gets the share done now and then.
[[nodiscard]] WideBvh build_wide_bvh(const Scene& scene, unsigned width, unsigned block,
                                     float reach, const std::function<void(double)>& report = {});

/// The largest absolute coordinate at which rays of `camera` through a scene start or end.
[[nodiscard]] float reach_of(const Scene& scene, const Camera& camera);

}  // namespace manylight

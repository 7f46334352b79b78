// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "shared/light.h"
#include "shared/octree.h"

namespace manylight {

/// The octree of the lights that emit anything; where none does, of the first. Cells are shrunk to
/// the positions in them and halved along the axes along which they are at least half as long as
/// along any, so that a node has 2 to 8 children. Lights at one place are told apart by the octants
/// of their emission axes in the same way, and then cut into eighths.
[[nodiscard]] std::vector<OctreeNode> build_octree(const std::vector<Light>& lights);

}  // namespace manylight

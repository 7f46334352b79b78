// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "scene/scene.hpp"
#include "shared/light_tree.h"

namespace manylight {

/// Binary trees of a scene's lights, for kernels/lib/light_tree.h.
struct LightTree {
    std::vector<Light> lights;     // the scene's, in the trees' order
    std::vector<uint> order;       // [position in lights] index in Scene::lights
    std::vector<LightNode> nodes;  // depth-first, see shared/light_tree.h
    std::vector<uint> roots;       // of directional lights, if any; of the others, if any
};

/// Builds top-down in parallel: 12 bins on each axis, and the split with the least sum over both
/// sides of power x squared diagonal x spread of the emission axes, after the surface area
/// orientation heuristic of Conty Estevez and Kulla, "Importance Sampling of Many Lights with
/// Adaptive Tree Splitting" (2018), whose cone is replaced by the length of the mean axis: sums
/// are fast. Lights at one place are split by their axes. The result does not depend on the number
/// of threads. `seen`, where it is given, says which lights anything is seen by: they are on the
/// left of a root, the others on its right.
[[nodiscard]] LightTree build_light_tree(const std::vector<Light>& lights,
                                         const std::vector<bool>& seen = {});

}  // namespace manylight

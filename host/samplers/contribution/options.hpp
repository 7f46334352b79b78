// SPDX-License-Identifier: MIT
#pragma once

#include "stages/refinement.hpp"

namespace manylight {

/// The paper's parameters; it does not give their values.
struct ClusterOptions {
    unsigned tile_size = 32;      // pixels, a power of two from 8 to 128; paper 4.1
    unsigned max_depth = 3;       // of the quadtree
    float normal_threshold = 10;  // degrees between two corners' normals
    ShadowRule shadow;
};

}  // namespace manylight

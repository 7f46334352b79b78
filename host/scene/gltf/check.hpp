// SPDX-License-Identifier: MIT
#pragma once

#include "scene/gltf/file.hpp"

namespace manylight {

/// Checks all values of the JSON: types, ranges, indices, node hierarchy, URIs, versions. Throws
/// InputError for what has no sensible reading.
void check_gltf(const GltfFile& file);

}  // namespace manylight

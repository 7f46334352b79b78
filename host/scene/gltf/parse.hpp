// SPDX-License-Identifier: MIT
#pragma once

// First: tinygltf's implementation includes nlohmann's header as hidden.
#include "scene/gltf/file.hpp"

#include <tiny_gltf.h>

namespace manylight {

/// The file as tinygltf's model, buffers filled, images left out; call check_gltf() first.
[[nodiscard]] tinygltf::Model parse_gltf(const GltfFile& file);

/// Has the library read and parse a .glb or .gltf file, and nothing else: what loading is measured
/// against. Throws InputError.
void parse_alone(const std::string& path);

}  // namespace manylight

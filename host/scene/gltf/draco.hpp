// SPDX-License-Identifier: MIT
// Meshes compressed by Draco (KHR_draco_mesh_compression).
#pragma once

#include "scene/gltf/accessors.hpp"

namespace manylight {

/// Decodes the compressed primitives of a mesh and has `accessors` read them instead of buffer
/// views. Throws InputError naming the primitive, also where the data hold other numbers of
/// vertices or triangles than the accessors: what is not announced is not decoded.
void decode_draco(const GltfFile& file, const tinygltf::Model& model, int mesh,
                  Accessors& accessors);

}  // namespace manylight

// SPDX-License-Identifier: MIT
#pragma once

#include "scene/gltf/parse.hpp"
#include "scene/scene.hpp"

namespace manylight {

/// Fills the scene's maps, textures and texels with what its materials name; `used` says which
/// materials are rendered, of which the images are decoded. Returns the n of the TEXCOORD_n that
/// each of Scene::coordinates holds. Textures without an image, or whose file is not there, are
/// left out, and noted. Throws InputError for images that cannot be read or decoded, or whose
/// texels would take more than `most_bytes`.
[[nodiscard]] std::vector<unsigned> load_textures(const GltfFile& file,
                                                  const tinygltf::Model& model,
                                                  const std::vector<bool>& used,
                                                  std::size_t most_bytes, Scene& scene,
                                                  Notes& notes);

}  // namespace manylight

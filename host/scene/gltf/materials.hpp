// SPDX-License-Identifier: MIT
#pragma once

#include "scene/gltf/loading.hpp"

namespace manylight {

/// Adds the file's materials, without their textures, and behind them glTF's default material, of
/// primitives that name none. Throws InputError for emission out of range.
void add_materials(Loading& in);

/// Limits reflectance to all light that there is, where no texture is still to be multiplied in;
/// the scene has its maps.
void limit_reflectance(Scene& scene);

/// [material of the file] whether a primitive has it.
[[nodiscard]] std::vector<bool> used_materials(const tinygltf::Model& model);

}  // namespace manylight

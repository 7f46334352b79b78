// SPDX-License-Identifier: MIT
// What is asked of tinygltf's model in several places.
#pragma once

#include "scene/gltf/parse.hpp"

namespace manylight {

/// A number of an extension's object, or `otherwise` where there is none.
[[nodiscard]] float number(const tinygltf::Value& object, const char* key, double otherwise);

/// An object's extension; a value of no type where there is none.
[[nodiscard]] const tinygltf::Value& extension(const tinygltf::ExtensionMap& extensions,
                                               const char* name);

/// By a primitive's mode: whether it is lines or points; whether each three corners are a triangle.
[[nodiscard]] bool is_lines_or_points(int mode);
[[nodiscard]] bool is_list(int mode);

/// Whether a primitive that has positions has none of them, or no corners.
[[nodiscard]] bool is_empty(const tinygltf::Model& model, const tinygltf::Primitive& primitive);

/// Whether there are triangles of a primitive.
[[nodiscard]] bool is_rendered(const tinygltf::Model& model, const tinygltf::Primitive& primitive);

/// Its number in Scene::materials.
[[nodiscard]] int material_of(const tinygltf::Model& model, const tinygltf::Primitive& primitive);

}  // namespace manylight

// SPDX-License-Identifier: MIT
#include "scene/gltf/model.hpp"

namespace manylight {

float number(const tinygltf::Value& object, const char* key, double otherwise) {
    if (!object.IsObject() || !object.Has(key)) return static_cast<float>(otherwise);
    return static_cast<float>(object.Get(key).GetNumberAsDouble());
}

const tinygltf::Value& extension(const tinygltf::ExtensionMap& extensions, const char* name) {
    static const tinygltf::Value none;
    const auto found = extensions.find(name);
    return found == extensions.end() ? none : found->second;
}

bool is_lines_or_points(int mode) { return mode >= 0 && mode <= TINYGLTF_MODE_LINE_STRIP; }

bool is_list(int mode) { return mode == TINYGLTF_MODE_TRIANGLES || mode == -1; }

bool is_empty(const tinygltf::Model& model, const tinygltf::Primitive& primitive) {
    return model.accessors[primitive.attributes.at("POSITION")].count == 0 ||
           (primitive.indices >= 0 && model.accessors[primitive.indices].count == 0);
}

bool is_rendered(const tinygltf::Model& model, const tinygltf::Primitive& primitive) {
    return !is_lines_or_points(primitive.mode) && primitive.attributes.contains("POSITION") &&
           !is_empty(model, primitive);
}

// One that names none has the one behind the file's (see add_materials()).
int material_of(const tinygltf::Model& model, const tinygltf::Primitive& primitive) {
    return primitive.material >= 0 ? primitive.material : static_cast<int>(model.materials.size());
}

}  // namespace manylight

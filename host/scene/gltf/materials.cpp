// SPDX-License-Identifier: MIT
#include "scene/gltf/materials.hpp"

#include <algorithm>

#include "scene/gltf/model.hpp"

namespace manylight {
namespace {

// Material of a primitive that names none: glTF's defaults.
Material default_material() {
    Material m{};
    m.base_color = float4(1);
    m.reflectance = float4(glm::vec3(USUAL_REFLECTANCE), 0);
    m.roughness = m.specular = m.alpha = 1;
    return m;
}

// At normal incidence; an index of 0 reflects everything.
float4 reflectance(const tinygltf::Value& ior, const tinygltf::Value& specular) {
    float4 f0(glm::vec3(USUAL_REFLECTANCE), 0);
    if (ior.Has("ior")) {
        const float index = number(ior, "ior", 1.5);
        const float root = (index - 1) / (index + 1);
        f0 = float4(glm::vec3(root * root), 0);
    }
    if (!specular.Has("specularColorFactor")) return f0;
    for (int c = 0; c < 3; ++c) {
        const auto& factor = specular.Get("specularColorFactor").Get(c);
        f0[c] *= static_cast<float>(factor.GetNumberAsDouble());
    }
    return f0;
}

// As bright as its base colour, in cd/m2, to all sides, whatever shines on it.
void make_unlit(Material& m) {
    m.emission = float4(glm::vec3(m.base_color), 1);
    m.base_color = float4(0);
    m.specular = 0;
    m.unlit = 1;
}

Material read_material(const tinygltf::Material& in, bool cull_back_faces) {
    const auto& pbr = in.pbrMetallicRoughness;
    const float strength =
        number(extension(in.extensions, "KHR_materials_emissive_strength"), "emissiveStrength", 1);
    Material m = default_material();
    m.base_color = float4(pbr.baseColorFactor[0], pbr.baseColorFactor[1], pbr.baseColorFactor[2],
                          pbr.metallicFactor);
    m.emission = float4(
        glm::vec3(in.emissiveFactor[0], in.emissiveFactor[1], in.emissiveFactor[2]) * strength,
        in.doubleSided ? 1 : 0);
    const auto roughness = static_cast<float>(pbr.roughnessFactor);
    m.roughness = std::max(roughness * roughness, SMALLEST_ALPHA);
    m.alpha = static_cast<float>(pbr.baseColorFactor[3]);
    // A cutoff of 0 leaves everything there.
    if (in.alphaMode == "MASK") m.cutoff = static_cast<float>(in.alphaCutoff);
    if (in.alphaMode == "BLEND") m.cutoff = -1;
    if (cull_back_faces && !in.doubleSided) m.culled = 1;
    const tinygltf::Value& specular = extension(in.extensions, "KHR_materials_specular");
    m.specular = number(specular, "specularFactor", 1);
    m.reflectance = reflectance(extension(in.extensions, "KHR_materials_ior"), specular);
    if (in.extensions.contains("KHR_materials_unlit")) make_unlit(m);
    return m;
}

}  // namespace

void add_materials(Loading& in) {
    Scene& scene = in.scene;
    for (const tinygltf::Material& material : in.model.materials) {
        const Material m = read_material(material, in.options.cull_back_faces);
        in.check_brightness(m.emission,
                            fmt::format("materials[{}]: emission", scene.materials.size()));
        scene.materials.push_back(m);
        scene.material_names.push_back(material.name);
    }
    scene.materials.push_back(default_material());
    scene.material_names.emplace_back();
    if (in.options.cull_back_faces) scene.materials.back().culled = 1;
}

void limit_reflectance(Scene& scene) {
    for (std::size_t i = 0; i < scene.materials.size(); ++i)
        if (!has_map(scene, i, MAP_SPECULAR_COLOR))
            for (int c = 0; c < 3; ++c)
                scene.materials[i].reflectance[c] =
                    std::min(scene.materials[i].reflectance[c], 1.f);
}

std::vector<bool> used_materials(const tinygltf::Model& model) {
    std::vector<bool> used(model.materials.size(), false);
    for (const tinygltf::Mesh& mesh : model.meshes)
        for (const tinygltf::Primitive& primitive : mesh.primitives)
            if (primitive.material >= 0) used[primitive.material] = true;
    return used;
}

}  // namespace manylight

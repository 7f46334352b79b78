// SPDX-License-Identifier: MIT
#define GLM_ENABLE_EXPERIMENTAL
#include "scene/gltf/writer.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtx/quaternion.hpp>

#include "error.hpp"
#include "output/write_file.hpp"

namespace manylight {
namespace {

nlohmann::json numbers(glm::vec3 v) { return {v.x, v.y, v.z}; }

nlohmann::json elements(const glm::mat4& m) {
    nlohmann::json out = nlohmann::json::array();
    for (int c = 0; c < 4; ++c)
        for (int r = 0; r < 4; ++r) out.push_back(m[c][r]);
    return out;
}

}  // namespace

void Mesh::add_quad(glm::vec3 corner, glm::vec3 u, glm::vec3 v) {
    const auto base = static_cast<std::uint32_t>(positions.size());
    for (const glm::vec3 p : {corner, corner + u, corner + u + v, corner + v})
        positions.push_back(p);
    for (const std::uint32_t i : {0, 1, 2, 0, 2, 3}) indices.push_back(base + i);
}

void Mesh::add_walls(float half, float height) {
    const float side = 2 * half;
    add_quad({-half, 0, -half}, {side, 0, 0}, {0, height, 0});
    add_quad({-half, 0, half}, {0, 0, -side}, {0, height, 0});
    add_quad({half, 0, -half}, {0, 0, side}, {0, height, 0});
}

void Mesh::add_triangle(glm::vec3 a, glm::vec3 b, glm::vec3 c) {
    for (const glm::vec3 p : {a, b, c}) {
        indices.push_back(static_cast<std::uint32_t>(positions.size()));
        positions.push_back(p);
    }
}

void Mesh::add_box(glm::vec3 centre, glm::vec3 size, float angle) {
    const glm::vec3 x = size.x * glm::vec3(std::cos(angle), 0, -std::sin(angle));
    const glm::vec3 z = size.z * glm::vec3(std::sin(angle), 0, std::cos(angle));
    const glm::vec3 y(0, size.y, 0);
    const glm::vec3 o = centre - (x + z) / 2.f;
    add_quad(o + z, x, y);       // front
    add_quad(o + x, -x, y);      // back
    add_quad(o, z, y);           // left
    add_quad(o + x + z, -z, y);  // right
    add_quad(o + y + z, x, -z);  // top
    add_quad(o, x, z);           // bottom
}

GltfWriter::GltfWriter() {
    json_ = {{"asset", {{"version", "2.0"}, {"generator", "manylight"}}},
             {"scene", 0},
             {"scenes", {{{"nodes", nlohmann::json::array()}}}}};
}

void GltfWriter::use(const char* extension) {
    auto& used = json_["extensionsUsed"];
    if (std::ranges::find(used, extension) == used.end()) used.push_back(extension);
}

int GltfWriter::add_material(glm::vec3 color, float metallic, float roughness) {
    json_["materials"].push_back({{"pbrMetallicRoughness",
                                   {{"baseColorFactor", {color.r, color.g, color.b, 1}},
                                    {"metallicFactor", metallic},
                                    {"roughnessFactor", roughness}}}});
    return static_cast<int>(json_["materials"].size()) - 1;
}

int GltfWriter::add_diffuse(glm::vec3 color) {
    const int index = add_material(color, 0, 1);
    use("KHR_materials_specular");
    json_["materials"][index]["extensions"]["KHR_materials_specular"] = {{"specularFactor", 0}};
    return index;
}

int GltfWriter::add_emitter(glm::vec3 radiance) {
    const int index = add_diffuse(glm::vec3(0));
    use("KHR_materials_emissive_strength");
    const float strength = std::max({radiance.r, radiance.g, radiance.b});
    nlohmann::json& material = json_["materials"][index];
    material["emissiveFactor"] = numbers(radiance / strength);
    material["extensions"]["KHR_materials_emissive_strength"] = {{"emissiveStrength", strength}};
    return index;
}

int GltfWriter::add_accessor(const void* data, std::size_t bytes, std::size_t count, int component,
                             const char* type, int target) {
    const std::size_t offset = binary_.size();
    binary_.resize(offset + bytes);
    std::memcpy(binary_.data() + offset, data, bytes);
    json_["bufferViews"].push_back(
        {{"buffer", 0}, {"byteOffset", offset}, {"byteLength", bytes}, {"target", target}});
    json_["accessors"].push_back({{"bufferView", json_["bufferViews"].size() - 1},
                                  {"componentType", component},
                                  {"count", count},
                                  {"type", type}});
    return static_cast<int>(json_["accessors"].size()) - 1;
}

int GltfWriter::add_shape(const std::string& name, const Mesh& mesh, int material) {
    constexpr int array_buffer = 34962;
    constexpr int element_buffer = 34963;
    constexpr int float_type = 5126;
    constexpr int uint_type = 5125;
    glm::vec3 lower(INFINITY);
    glm::vec3 upper(-INFINITY);
    for (const glm::vec3 p : mesh.positions) {
        lower = glm::min(lower, p);
        upper = glm::max(upper, p);
    }
    const int positions = add_accessor(mesh.positions.data(), mesh.positions.size() * 12,
                                       mesh.positions.size(), float_type, "VEC3", array_buffer);
    json_["accessors"][positions]["min"] = numbers(lower);
    json_["accessors"][positions]["max"] = numbers(upper);
    nlohmann::json attributes = {{"POSITION", positions}};
    if (!mesh.normals.empty())
        attributes["NORMAL"] = add_accessor(mesh.normals.data(), mesh.normals.size() * 12,
                                            mesh.normals.size(), float_type, "VEC3", array_buffer);
    const int indices = add_accessor(mesh.indices.data(), mesh.indices.size() * 4,
                                     mesh.indices.size(), uint_type, "SCALAR", element_buffer);
    json_["meshes"].push_back(
        {{"name", name},
         {"primitives",
          {{{"attributes", attributes}, {"indices", indices}, {"material", material}}}}});
    return static_cast<int>(json_["meshes"].size()) - 1;
}

void GltfWriter::add_mesh(const std::string& name, const Mesh& mesh, int material) {
    json_["nodes"].push_back({{"name", name}, {"mesh", add_shape(name, mesh, material)}});
}

void GltfWriter::add_node(const std::string& name, int shape, const glm::mat4& to_world) {
    json_["nodes"].push_back({{"name", name}, {"mesh", shape}, {"matrix", elements(to_world)}});
}

void GltfWriter::add_light(nlohmann::json light, glm::vec3 position, glm::vec3 direction) {
    use("KHR_lights_punctual");
    auto& lights = json_["extensions"]["KHR_lights_punctual"]["lights"];
    lights.push_back(std::move(light));
    nlohmann::json node = {
        {"translation", numbers(position)},
        {"extensions", {{"KHR_lights_punctual", {{"light", lights.size() - 1}}}}}};
    if (direction != glm::vec3(0)) {  // lights shine along their node's -z
        const glm::dquat q =
            glm::rotation(glm::dvec3(0, 0, -1), glm::normalize(glm::dvec3(direction)));
        node["rotation"] = {q.x, q.y, q.z, q.w};
    }
    json_["nodes"].push_back(std::move(node));
}

namespace {

nlohmann::json light_of(const char* type, glm::vec3 color) {
    const float intensity = std::max({color.r, color.g, color.b});
    return {{"type", type}, {"color", numbers(color / intensity)}, {"intensity", intensity}};
}

}  // namespace

void GltfWriter::add_point(glm::vec3 position, glm::vec3 intensity) {
    add_light(light_of("point", intensity), position, glm::vec3(0));
}

void GltfWriter::add_spot(glm::vec3 position, glm::vec3 direction, glm::vec3 intensity, float inner,
                          float outer) {
    nlohmann::json light = light_of("spot", intensity);
    light["spot"] = {{"innerConeAngle", inner}, {"outerConeAngle", outer}};
    add_light(std::move(light), position, direction);
}

void GltfWriter::add_directional(glm::vec3 direction, glm::vec3 illuminance) {
    add_light(light_of("directional", illuminance), glm::vec3(0), direction);
}

void GltfWriter::add_camera(const std::string& name, glm::vec3 eye, glm::vec3 target, float yfov,
                            float aspect) {
    const double near = std::min(0.01, 0.01 * double{glm::distance(eye, target)});
    json_["cameras"].push_back(
        {{"name", name},
         {"type", "perspective"},
         {"perspective", {{"yfov", yfov}, {"aspectRatio", aspect}, {"znear", near}}}});
    const glm::mat4 to_world = glm::inverse(glm::lookAt(eye, target, glm::vec3(0, 1, 0)));
    json_["nodes"].push_back(
        {{"name", name}, {"camera", json_["cameras"].size() - 1}, {"matrix", elements(to_world)}});
}

void GltfWriter::set_emitter_points(unsigned points) {
    json_["scenes"][0]["extras"]["emitter_points"] = points;
}

void GltfWriter::write(const std::string& path) const {
    nlohmann::json json = json_;
    for (std::size_t i = 0; i < json["nodes"].size(); ++i) json["scenes"][0]["nodes"].push_back(i);
    json["buffers"] = {{{"byteLength", binary_.size()}}};
    std::string text = json.dump();
    text.resize((text.size() + 3) / 4 * 4, ' ');
    std::vector<char> binary = binary_;
    binary.resize((binary.size() + 3) / 4 * 4, 0);
    const std::uint64_t length = 28 + text.size() + binary.size();
    if (length > 0xffffffffu) throw RuntimeError("{}: a .glb file has at most 4 GiB", path);

    std::string bytes;
    const auto append = [&bytes](const void* data, std::size_t size) {
        bytes.append(static_cast<const char*>(data), size);
    };
    const auto word = [&append](std::size_t value) {
        const auto w = static_cast<std::uint32_t>(value);
        append(&w, 4);
    };
    for (const std::size_t w : {std::size_t{0x46546c67}, std::size_t{2}, std::size_t{length}})
        word(w);
    word(text.size());
    word(0x4e4f534a);
    append(text.data(), text.size());
    word(binary.size());
    word(0x004e4942);
    append(binary.data(), binary.size());
    write_file(path, std::as_bytes(std::span(bytes)));
}

}  // namespace manylight

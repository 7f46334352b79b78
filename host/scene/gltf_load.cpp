// SPDX-License-Identifier: MIT
#define GLM_ENABLE_EXPERIMENTAL
#include <algorithm>
#include <bit>
#include <cstring>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/gtc/type_ptr.hpp>
#include <glm/gtx/component_wise.hpp>

#include "error.hpp"
#include "scene/alpha.hpp"
#include "scene/gltf.hpp"
#include "scene/gltf_textures.hpp"

namespace manylight {
namespace {

// Beyond these, sums and squares in single precision would overflow. The sun's disc has 1.6e9
// cd/m2.
constexpr float brightest = 1e15f;  // cd, lx or cd/m2
constexpr float farthest = 1e9f;    // m

float number(const tinygltf::Value& object, const char* key, double otherwise) {
    if (!object.IsObject() || !object.Has(key)) return static_cast<float>(otherwise);
    return static_cast<float>(object.Get(key).GetNumberAsDouble());
}

const tinygltf::Value& extension(const tinygltf::ExtensionMap& extensions, const char* name) {
    static const tinygltf::Value none;
    const auto found = extensions.find(name);
    return found == extensions.end() ? none : found->second;
}

glm::dmat4 local_transform(const tinygltf::Node& node) {
    if (node.matrix.size() == 16) return glm::make_mat4(node.matrix.data());
    glm::dmat4 m(1.0);
    if (node.translation.size() == 3)
        m = glm::translate(m, glm::make_vec3(node.translation.data()));
    if (node.rotation.size() == 4)
        m *= glm::mat4_cast(glm::normalize(
            glm::dquat(node.rotation[3], node.rotation[0], node.rotation[1], node.rotation[2])));
    if (node.scale.size() == 3) m = glm::scale(m, glm::make_vec3(node.scale.data()));
    return m;
}

class Loader {
  public:
    explicit Loader(const GltfFile& file) : file_(file), model_(parse_gltf(file)) {
        scene_.file = file.path;
    }

    Scene load() {
        for (const tinygltf::Material& material : model_.materials) add_material(material);
        scene_.materials.push_back(default_material());
        scene_.material_names.emplace_back();
        coordinate_sets_ = load_textures(file_, model_, used_materials(), scene_);
        visit_nodes();
        find_alpha(scene_);
        note_what_is_not_rendered();
        if (!has_normals_) scene_.vertex_normals.clear();
        return std::move(scene_);
    }

  private:
    // Material of a primitive that names none: glTF's defaults.
    static Material default_material() {
        Material m{};
        m.base_color = float4(1);
        m.reflectance = float4(glm::vec3(USUAL_REFLECTANCE), 0);
        m.roughness = m.specular = m.alpha = 1;
        return m;
    }

    void add_material(const tinygltf::Material& in) {
        const auto& pbr = in.pbrMetallicRoughness;
        const float strength = number(extension(in.extensions, "KHR_materials_emissive_strength"),
                                      "emissiveStrength", 1);
        Material m = default_material();
        m.base_color = float4(pbr.baseColorFactor[0], pbr.baseColorFactor[1],
                              pbr.baseColorFactor[2], pbr.metallicFactor);
        m.emission = float4(
            glm::vec3(in.emissiveFactor[0], in.emissiveFactor[1], in.emissiveFactor[2]) * strength,
            in.doubleSided ? 1 : 0);
        const auto roughness = static_cast<float>(pbr.roughnessFactor);
        m.roughness = std::max(roughness * roughness, SMALLEST_ALPHA);
        m.alpha = static_cast<float>(pbr.baseColorFactor[3]);
        // A cutoff of 0 leaves everything there.
        if (in.alphaMode == "MASK") m.cutoff = static_cast<float>(in.alphaCutoff);
        if (in.alphaMode == "BLEND") m.cutoff = -1;
        const tinygltf::Value& specular = extension(in.extensions, "KHR_materials_specular");
        m.specular = number(specular, "specularFactor", 1);
        m.reflectance = reflectance(extension(in.extensions, "KHR_materials_ior"), specular);
        if (in.extensions.contains("KHR_materials_unlit")) make_unlit(m);
        check_brightness(m.emission,
                         fmt::format("materials[{}]: emission", scene_.materials.size()));
        scene_.materials.push_back(m);
        scene_.material_names.push_back(in.name);
    }

    // At normal incidence; an index of 0 reflects everything.
    static float4 reflectance(const tinygltf::Value& ior, const tinygltf::Value& specular) {
        float4 f0(glm::vec3(USUAL_REFLECTANCE), 0);
        if (ior.Has("ior")) {
            const float index = number(ior, "ior", 1.5);
            const float root = (index - 1) / (index + 1);
            f0 = float4(glm::vec3(root * root), 0);
        }
        if (!specular.Has("specularColorFactor")) return f0;
        for (int c = 0; c < 3; ++c) {
            const auto& factor = specular.Get("specularColorFactor").Get(c);
            f0[c] = std::min(f0[c] * static_cast<float>(factor.GetNumberAsDouble()), 1.f);
        }
        return f0;
    }

    // As bright as its base colour, in cd/m2, to all sides, whatever shines on it.
    static void make_unlit(Material& m) {
        m.emission = float4(glm::vec3(m.base_color), 1);
        m.base_color = float4(0);
        m.specular = 0;
        m.unlit = 1;
    }

    [[nodiscard]] std::vector<bool> used_materials() const {
        std::vector<bool> used(model_.materials.size(), false);
        for (const tinygltf::Mesh& mesh : model_.meshes)
            for (const tinygltf::Primitive& primitive : mesh.primitives)
                if (primitive.material >= 0) used[primitive.material] = true;
        return used;
    }

    void check_brightness(const glm::vec3& rgb, const std::string& where) const {
        if (!(glm::compMax(rgb) <= brightest))
            throw InputError("{}: {}: {} is out of range: more than {}", scene_.file, where,
                             glm::compMax(rgb), brightest);
    }

    // The direction of a node's axis in the world, unit.
    glm::dvec3 direction(const glm::dmat4& to_world, const glm::dvec3& axis, int node) const {
        const glm::dvec3 d = glm::dmat3(to_world) * axis;
        const double length = glm::length(d);
        if (!(length > 1e-30 && length < 1e30))
            throw InputError("{}: nodes[{}]: its transform leaves no direction (scale {})",
                             scene_.file, node, length);
        return d / length;
    }

    void visit_nodes() {
        std::vector<int> roots;
        if (!model_.scenes.empty()) {
            const auto& scene = model_.scenes[std::max(model_.defaultScene, 0)];
            roots = scene.nodes;
            if (scene.extras.IsObject() && scene.extras.Has("emitter_points"))
                scene_.emitter_points = scene.extras.Get("emitter_points").GetNumberAsInt();
        } else if (!model_.nodes.empty()) {
            throw InputError("{}: scenes: the file has nodes but no scene", scene_.file);
        }
        std::vector<std::pair<int, glm::dmat4>> open;
        for (auto root = roots.rbegin(); root != roots.rend(); ++root)
            open.emplace_back(*root, glm::dmat4(1.0));
        while (!open.empty()) {
            const auto [index, parent] = open.back();
            open.pop_back();
            const tinygltf::Node& node = model_.nodes[index];
            const glm::dmat4 to_world = parent * local_transform(node);
            for (int c = 0; c < 4; ++c)
                if (!(glm::compMax(glm::abs(to_world[c])) <= farthest))
                    throw InputError(
                        "{}: nodes[{}]: its transform is out of range: {} is more than {}",
                        scene_.file, index, glm::compMax(glm::abs(to_world[c])), farthest);
            if (node.mesh >= 0) add_mesh(node.mesh, to_world);
            if (node.camera >= 0) add_camera(index, to_world);
            const auto& light = extension(node.extensions, "KHR_lights_punctual");
            if (light.IsObject()) add_light(light.Get("light").GetNumberAsInt(), index, to_world);
            for (auto child = node.children.rbegin(); child != node.children.rend(); ++child)
                open.emplace_back(*child, to_world);
        }
    }

    void add_camera(int index, const glm::dmat4& to_world) {
        const tinygltf::Node& node = model_.nodes[index];
        const tinygltf::Camera& camera = model_.cameras[node.camera];
        View view;
        view.name = !node.name.empty() ? node.name : camera.name;
        if (view.name.empty()) view.name = std::to_string(scene_.views.size());
        view.camera_name = camera.name;
        // Only place and direction count: scale, shear and mirroring are left out.
        const glm::dvec3 back = direction(to_world, {0, 0, 1}, index);
        const glm::dvec3 right = glm::cross(direction(to_world, {0, 1, 0}, index), back);
        if (!(glm::length(right) > 1e-6))
            throw InputError("{}: nodes[{}]: its transform leaves no up direction", scene_.file,
                             index);
        view.to_world[0] = glm::dvec4(glm::normalize(right), 0);
        view.to_world[1] = glm::dvec4(glm::cross(back, glm::normalize(right)), 0);
        view.to_world[2] = glm::dvec4(back, 0);
        view.to_world[3] = to_world[3];
        view.orthographic = camera.type == "orthographic";
        if (view.orthographic) {
            view.aspect = camera.orthographic.xmag / camera.orthographic.ymag;
            view.half_height = camera.orthographic.ymag;
        } else {
            view.aspect = std::max(camera.perspective.aspectRatio, 0.0);
            view.half_height = std::tan(camera.perspective.yfov / 2);
        }
        scene_.views.push_back(view);
    }

    void add_light(int index, int node, const glm::dmat4& to_world) {
        const tinygltf::Light& in = model_.lights[index];
        glm::vec3 color(1);
        if (in.color.size() == 3) color = glm::vec3(in.color[0], in.color[1], in.color[2]);
        color *= static_cast<float>(in.intensity);
        if (color == glm::vec3(0)) return;
        check_brightness(color,
                         fmt::format("KHR_lights_punctual.lights[{}]: color x intensity", index));
        const glm::dvec3 shines =
            in.type == "point" ? glm::dvec3(0) : direction(to_world, {0, 0, -1}, node);
        const auto position = glm::vec3(glm::dvec3(to_world[3]));
        Light light{float4(position, LIGHT_POINT), float4(glm::vec3(shines), in.range), float4(0),
                    float4(color, 0)};
        if (in.type == "spot") {
            light.position.w = LIGHT_SPOT;
            const double outer = std::cos(in.spot.outerConeAngle);
            const double scale = 1 / std::max(0.001, std::cos(in.spot.innerConeAngle) - outer);
            light.edge = float4(scale, -outer * scale, 0, 0);
        } else if (in.type == "directional") {
            light.position.w = LIGHT_DIRECTIONAL;
            light.axis.w = 0;
        }
        scene_.lights.push_back(light);
        const std::string& name = model_.nodes[node].name;
        scene_.light_names.push_back(name.empty() ? in.name : name);
    }

    void add_mesh(int index, const glm::dmat4& to_world) {
        for (std::size_t p = 0; p < model_.meshes[index].primitives.size(); ++p) {
            const auto& primitive = model_.meshes[index].primitives[p];
            const std::string where = fmt::format("meshes[{}].primitives[{}]", index, p);
            if (primitive.mode >= 0 && primitive.mode <= TINYGLTF_MODE_LINE_STRIP) {
                ++lines_and_points_;
                continue;
            }
            if (!primitive.attributes.contains("POSITION")) {
                ++without_position_;
                continue;
            }
            add_primitive(primitive, where, to_world);
        }
    }

    void add_primitive(const tinygltf::Primitive& primitive, const std::string& where,
                       const glm::dmat4& to_world) {
        const std::vector<glm::vec3> positions =
            read_vectors(primitive.attributes.at("POSITION"), where + ".attributes.POSITION");
        std::vector<glm::vec3> normals;
        if (primitive.attributes.contains("NORMAL")) {
            normals = read_vectors(primitive.attributes.at("NORMAL"), where + ".attributes.NORMAL");
            if (normals.size() != positions.size())
                throw InputError("{}: {}.attributes.NORMAL: {} normals for {} positions",
                                 scene_.file, where, normals.size(), positions.size());
            has_normals_ = true;
        }
        const std::size_t base = scene_.vertices.size();
        if (base + positions.size() > 0xffffffffu)
            throw InputError("{}: {}: more than 2^32 vertices", scene_.file, where);
        const glm::dmat3 linear(to_world);
        const glm::dmat3 to_normal = glm::transpose(glm::inverse(linear));
        for (std::size_t v = 0; v < positions.size(); ++v) {
            scene_.vertices.emplace_back(to_world * glm::dvec4(positions[v], 1));
            glm::dvec3 normal(0);
            if (!normals.empty()) {
                normal = to_normal * glm::dvec3(normals[v]);
                const double length = glm::length(normal);
                normal = std::isfinite(length) && length > 0 ? normal / length : glm::dvec3(0);
            }
            scene_.vertex_normals.emplace_back(normal);
            if (!(glm::compMax(glm::abs(scene_.vertices.back())) <= farthest))
                throw InputError(
                    "{}: {}.attributes.POSITION: vertex {} is out of range in the world: more than "
                    "{}",
                    scene_.file, where, v, farthest);
        }
        const bool mirrored = glm::determinant(linear) < 0;  // turns the winding round
        const int material = primitive.material >= 0 ? primitive.material
                                                     : static_cast<int>(model_.materials.size());
        add_coordinates(primitive, material, positions.size(), where);
        add_tangents(primitive, material, to_world, positions.size(), where);
        add_colors(primitive, positions.size(), where);
        add_triangles(corners(primitive, positions.size(), where), primitive.mode, base, mirrored,
                      material);
    }

    // Those that the scene's textures need; 0 where this primitive's do not.
    void add_coordinates(const tinygltf::Primitive& primitive, int material, std::size_t count,
                         const std::string& where) {
        for (std::size_t set = 0; set < coordinate_sets_.size(); ++set) {
            const std::string name = fmt::format("TEXCOORD_{}", coordinate_sets_[set]);
            std::vector<glm::vec2>& out = scene_.coordinates[set];
            if (!primitive.attributes.contains(name)) {
                if (needs_coordinates(material, set))
                    throw InputError(
                        "{}: {}: its material {} has a texture at {}, which is missing",
                        scene_.file, where, material, name);
                out.resize(out.size() + count, glm::vec2(0));
                continue;
            }
            for (const glm::vec4& v : read_normalized(primitive.attributes.at(name), 2, 2, count,
                                                      where + ".attributes." + name))
                out.emplace_back(v);
        }
    }

    [[nodiscard]] bool needs_coordinates(int material, std::size_t set) const {
        const auto first = scene_.maps.begin() + MAP_KIND_COUNT * material;
        return std::any_of(first, first + MAP_KIND_COUNT, [&](const TextureMap& map) {
            return map.texture != NO_TEXTURE && map.set == set;
        });
    }

    // Where a normal map and vertex normals need them.
    void add_tangents(const tinygltf::Primitive& primitive, int material,
                      const glm::dmat4& to_world, std::size_t count, const std::string& where) {
        const auto found = primitive.attributes.find("TANGENT");
        const bool used = found != primitive.attributes.end() && !scene_.maps.empty() &&
                          scene_.maps[MAP_KIND_COUNT * material + MAP_NORMAL].texture != NO_TEXTURE;
        if (!used) {
            if (!scene_.tangents.empty()) scene_.tangents.resize(scene_.vertices.size(), float4(0));
            return;
        }
        scene_.tangents.resize(scene_.vertices.size() - count, float4(0));
        const double mirrored = glm::determinant(glm::dmat3(to_world)) < 0 ? -1 : 1;
        for (const glm::vec4& v :
             read_normalized(found->second, 4, 4, count, where + ".attributes.TANGENT")) {
            const glm::dvec3 along = glm::dmat3(to_world) * glm::dvec3(v);
            const double length = glm::length(along);
            const bool valid = std::isfinite(length) && length > 0;
            scene_.tangents.push_back(
                valid ? float4(glm::vec3(along / length), v.w < 0 ? -mirrored : mirrored)
                      : float4(0));
        }
    }

    void add_colors(const tinygltf::Primitive& primitive, std::size_t count,
                    const std::string& where) {
        const auto found = primitive.attributes.find("COLOR_0");
        if (found == primitive.attributes.end()) {
            if (!scene_.colors.empty()) scene_.colors.resize(scene_.vertices.size(), float4(1));
            return;
        }
        scene_.colors.resize(scene_.vertices.size() - count, float4(1));
        for (const glm::vec4& v :
             read_normalized(found->second, 3, 4, count, where + ".attributes.COLOR_0"))
            scene_.colors.push_back(glm::clamp(v, 0.f, 1.f));
    }

    void add_triangles(const std::vector<std::uint32_t>& corners, int mode, std::size_t base,
                       bool mirrored, int material) {
        const bool list = mode == TINYGLTF_MODE_TRIANGLES || mode == -1;
        const std::size_t count = list                  ? corners.size() / 3
                                  : corners.size() >= 3 ? corners.size() - 2
                                                        : 0;
        for (std::size_t t = 0; t < count; ++t) {
            std::size_t c[3] = {3 * t, 3 * t + 1, 3 * t + 2};
            if (mode == TINYGLTF_MODE_TRIANGLE_STRIP) {
                c[0] = t, c[1] = t + 1 + t % 2, c[2] = t + 2 - t % 2;
            } else if (mode == TINYGLTF_MODE_TRIANGLE_FAN) {
                c[0] = t + 1, c[1] = t + 2, c[2] = 0;
            }
            if (mirrored) std::swap(c[1], c[2]);
            for (const std::size_t corner : c)
                scene_.indices.push_back(static_cast<std::uint32_t>(base + corners[corner]));
            scene_.triangle_materials.push_back(material);
        }
    }

    // The vertices of a primitive's corners, in order.
    std::vector<std::uint32_t> corners(const tinygltf::Primitive& primitive, std::size_t vertices,
                                       const std::string& where) {
        std::vector<std::uint32_t> corners;
        if (primitive.indices < 0) {
            corners.resize(vertices);
            for (std::size_t i = 0; i < vertices; ++i) corners[i] = static_cast<std::uint32_t>(i);
        } else {
            corners = read_indices(primitive.indices, where + ".indices");
        }
        for (std::size_t i = 0; i < corners.size(); ++i)
            if (corners[i] >= vertices)
                throw InputError("{}: {}.indices: element {} is {}, but there are {} vertices",
                                 scene_.file, where, i, corners[i], vertices);
        const bool list = primitive.mode == TINYGLTF_MODE_TRIANGLES || primitive.mode == -1;
        if (list && corners.size() % 3 != 0)
            throw InputError("{}: {}: {} corners are no whole number of triangles", scene_.file,
                             where, corners.size());
        return corners;
    }

    struct Elements {
        const unsigned char* data;
        std::size_t stride;
        std::size_t count;
    };

    // Where an accessor's elements lie; its range was checked by check_gltf().
    Elements elements(const tinygltf::Accessor& accessor, const std::string& where) {
        if (accessor.sparse.isSparse)
            throw InputError("{}: {}: sparse accessors are not supported", scene_.file, where);
        if (accessor.bufferView < 0)
            throw InputError("{}: {}: the accessor has no bufferView", scene_.file, where);
        const tinygltf::BufferView& view = model_.bufferViews[accessor.bufferView];
        const std::size_t offset = view.byteOffset + accessor.byteOffset;
        const auto stride = static_cast<std::size_t>(accessor.ByteStride(view));
        return {model_.buffers[view.buffer].data.data() + offset, stride, accessor.count};
    }

    std::vector<glm::vec3> read_vectors(int index, const std::string& where) {
        const tinygltf::Accessor& accessor = model_.accessors[index];
        if (accessor.type != TINYGLTF_TYPE_VEC3 ||
            accessor.componentType != TINYGLTF_COMPONENT_TYPE_FLOAT)
            throw InputError("{}: {}: accessor {} is not VEC3 of float (5126)", scene_.file, where,
                             index);
        const Elements in = elements(accessor, where);
        std::vector<glm::vec3> out(in.count);
        for (std::size_t i = 0; i < in.count; ++i) {
            std::memcpy(&out[i], in.data + i * in.stride, sizeof(glm::vec3));
            if (!std::isfinite(glm::compAdd(out[i] * 0.25f)))
                throw InputError("{}: {}: element {} ({}, {}, {}) is not finite", scene_.file,
                                 where, i, out[i].x, out[i].y, out[i].z);
        }
        return out;
    }

    // Vectors of floats, or of unsigned integers that mean 0 to 1; missing components are 1.
    std::vector<glm::vec4> read_normalized(int index, int fewest, int most, std::size_t count,
                                           const std::string& where) {
        const tinygltf::Accessor& accessor = model_.accessors[index];
        const int type = accessor.componentType;
        const int components = tinygltf::GetNumComponentsInType(accessor.type);
        const bool is_float = type == TINYGLTF_COMPONENT_TYPE_FLOAT;
        const bool is_fraction =
            accessor.normalized && (type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE ||
                                    type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT);
        if (components < fewest || components > most || accessor.type > TINYGLTF_TYPE_VEC4 ||
            !(is_float || is_fraction))
            throw InputError(
                "{}: {}: accessor {} is not VEC{} of float (5126) or normalized unsigned byte or "
                "short",
                scene_.file, where, index,
                most == 2     ? "2"
                : fewest == 4 ? "4"
                              : "3 or VEC4");
        if (accessor.count != count)
            throw InputError("{}: {}: {} values for {} positions", scene_.file, where,
                             accessor.count, count);
        const Elements in = elements(accessor, where);
        const int bytes = tinygltf::GetComponentSizeInBytes(type);
        std::vector<glm::vec4> out(in.count, glm::vec4(1));
        for (std::size_t i = 0; i < in.count; ++i)
            for (int c = 0; c < components; ++c) {
                const unsigned char* value = in.data + i * in.stride + c * bytes;
                std::uint32_t word = 0;
                std::memcpy(&word, value, bytes);
                out[i][c] = is_float ? std::bit_cast<float>(word)
                                     : static_cast<float>(word) / (bytes == 1 ? 255.f : 65535.f);
                if (!std::isfinite(out[i][c]))
                    throw InputError("{}: {}: element {} is not finite", scene_.file, where, i);
            }
        return out;
    }

    std::vector<std::uint32_t> read_indices(int index, const std::string& where) {
        const tinygltf::Accessor& accessor = model_.accessors[index];
        const int type = accessor.componentType;
        if (accessor.type != TINYGLTF_TYPE_SCALAR ||
            (type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE &&
             type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT &&
             type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT))
            throw InputError("{}: {}: accessor {} is not SCALAR of an unsigned integer type",
                             scene_.file, where, index);
        const Elements in = elements(accessor, where);
        const int bytes = tinygltf::GetComponentSizeInBytes(type);
        std::vector<std::uint32_t> out(in.count, 0);  // little-endian: low bytes first
        for (std::size_t i = 0; i < in.count; ++i)
            std::memcpy(&out[i], in.data + i * in.stride, bytes);
        return out;
    }

    void warn(std::size_t count, const char* what) {
        if (count > 0)
            scene_.warnings.push_back(fmt::format("{}: {} {}", scene_.file, count, what));
    }

    void note_what_is_not_rendered() {
        std::size_t textured = 0;
        for (const tinygltf::Material& m : model_.materials) {
            const auto& specular = extension(m.extensions, "KHR_materials_specular");
            const bool specular_texture =
                specular.Has("specularTexture") || specular.Has("specularColorTexture");
            textured += specular_texture;
        }
        std::size_t morphed = 0;
        for (const tinygltf::Mesh& mesh : model_.meshes)
            for (const tinygltf::Primitive& primitive : mesh.primitives)
                morphed += !primitive.targets.empty();
        warn(textured,
             "materials have specular textures, which are not rendered; their factors are");
        warn(model_.skins.size(), "skins are not applied; their meshes keep their rest pose");
        warn(morphed, "primitives have morph targets, which are not applied");
        warn(model_.animations.size(), "animations are not applied");
        warn(lines_and_points_, "primitives are points or lines, which are not rendered");
        warn(without_position_, "primitives have no POSITION and are not rendered");
        for (const std::string& name : model_.extensionsUsed)
            if (!known_extensions().contains(name))
                scene_.warnings.push_back(
                    fmt::format("{}: extension {} is not rendered", scene_.file, name));
    }

    const GltfFile& file_;
    tinygltf::Model model_;
    Scene scene_;
    std::vector<unsigned> coordinate_sets_;  // [set of Scene::coordinates] n of TEXCOORD_n
    bool has_normals_ = false;
    std::size_t lines_and_points_ = 0;
    std::size_t without_position_ = 0;
};

}  // namespace

Scene load_scene(const std::string& path) {
    const GltfFile file = read_gltf(path);
    check_gltf(file);
    return Loader(file).load();
}

}  // namespace manylight

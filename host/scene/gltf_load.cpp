// SPDX-License-Identifier: MIT
#define GLM_ENABLE_EXPERIMENTAL
#include <unistd.h>

#include <algorithm>
#include <glm/glm.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtx/component_wise.hpp>
#include <map>
#include <set>

#include "error.hpp"
#include "scene/alpha.hpp"
#include "scene/gltf.hpp"
#include "scene/gltf_draco.hpp"
#include "scene/gltf_extensions.hpp"
#include "scene/gltf_pose.hpp"
#include "scene/gltf_textures.hpp"
#include "scene/gltf_uri.hpp"

namespace manylight {
namespace {

// Beyond these, sums and squares in single precision would overflow. The sun's disc has 1.6e9
// cd/m2.
constexpr float brightest = 1e15f;  // cd, lx or cd/m2
constexpr float farthest = 1e9f;    // m

// What a scene holds of each at the least: a position and a normal; a triangle's corners, material,
// bounds while the BVH is built and place in it.
constexpr double vertex_bytes = 24;
constexpr double triangle_bytes = 96;
constexpr double instance_bytes = 512;       // its node above, too
constexpr double place_bytes = 176;          // of an instance while it is read
constexpr double worth_sharing = 256 << 20;  // bytes of copies
constexpr double most_steps = 4e9;           // a minute or two

float number(const tinygltf::Value& object, const char* key, double otherwise) {
    if (!object.IsObject() || !object.Has(key)) return static_cast<float>(otherwise);
    return static_cast<float>(object.Get(key).GetNumberAsDouble());
}

const tinygltf::Value& extension(const tinygltf::ExtensionMap& extensions, const char* name) {
    static const tinygltf::Value none;
    const auto found = extensions.find(name);
    return found == extensions.end() ? none : found->second;
}

class Loader {
  public:
    Loader(const GltfFile& file, const LoadOptions& options, const glm::dvec3& origin)
        : file_(file),
          model_(parse_gltf(file)),
          accessors_(file, model_),
          pose_(file, model_, accessors_, options.seconds, origin),
          options_(options) {
        scene_.file = file.path;
        scene_.origin = origin;
        notes_ = file.notes;
        for (const char* kind : {"buffers", "images"})
            if (file.json.contains(kind))
                for (const nlohmann::json& object : file.json[kind])
                    if (object.contains("uri") &&
                        !object["uri"].get_ref<const std::string&>().starts_with("data:"))
                        scene_.files.push_back(
                            file_of_uri(file, object["uri"], file.path).string());
    }

    Scene load() {
        find_nodes();
        for (const tinygltf::Material& material : model_.materials) add_material(material);
        scene_.materials.push_back(default_material());
        scene_.material_names.emplace_back();
        if (options_.cull_back_faces) scene_.materials.back().culled = 1;
        choose_shared();
        count_all();
        check_size();
        coordinate_sets_ =
            load_textures(file_, model_, used_materials(),
                          most_bytes() - static_cast<std::size_t>(needed_bytes()), scene_, notes_);
        limit_reflectance();
        decode_meshes();
        for (const int node : nodes_) visit_node(node);
        add_shared_meshes();
        find_alpha(scene_);
        note_what_is_not_rendered();
        if (!has_normals_) scene_.vertex_normals = {};
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
        if (options_.cull_back_faces && !in.doubleSided) m.culled = 1;
        const tinygltf::Value& specular = extension(in.extensions, "KHR_materials_specular");
        m.specular = number(specular, "specularFactor", 1);
        m.reflectance = reflectance(extension(in.extensions, "KHR_materials_ior"), specular);
        if (in.extensions.contains("KHR_materials_unlit")) make_unlit(m);
        check_brightness(m.emission,
                         fmt::format("materials[{}]: emission", scene_.materials.size()));
        scene_.materials.push_back(m);
        scene_.material_names.push_back(in.name);
    }

    // To all light that there is, where no texture is still to be multiplied in.
    void limit_reflectance() {
        for (std::size_t i = 0; i < scene_.materials.size(); ++i)
            if (!has_map(scene_, i, MAP_SPECULAR_COLOR))
                for (int c = 0; c < 3; ++c)
                    scene_.materials[i].reflectance[c] =
                        std::min(scene_.materials[i].reflectance[c], 1.f);
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
            f0[c] *= static_cast<float>(factor.GetNumberAsDouble());
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

    // The direction of a node's axis in the world, unit; 0 where its scale leaves none.
    static glm::dvec3 direction(const glm::dmat4& to_world, const glm::dvec3& axis) {
        const glm::dvec3 d = glm::dmat3(to_world) * axis;
        const double length = glm::length(d);
        return length > 1e-30 ? d / length : glm::dvec3(0);
    }

    // By a scale of 0 on all axes: glTF's way to hide what is at a node.
    static bool is_hidden(const glm::dmat4& to_world) {
        return glm::dmat3(to_world) == glm::dmat3(0);
    }

    // The nodes of the scene, parents first.
    void find_nodes() {
        std::vector<int> roots;
        if (!model_.scenes.empty()) {
            const auto& scene = model_.scenes[std::max(model_.defaultScene, 0)];
            roots = scene.nodes;
            if (scene.extras.IsObject() && scene.extras.Has("emitter_points"))
                scene_.emitter_points = scene.extras.Get("emitter_points").GetNumberAsInt();
        }
        std::vector<int> open(roots.rbegin(), roots.rend());
        while (!open.empty()) {
            const int index = open.back();
            open.pop_back();
            nodes_.push_back(index);
            const std::vector<int>& children = model_.nodes[index].children;
            open.insert(open.end(), children.rbegin(), children.rend());
        }
    }

    void decode_meshes() {
        std::set<int> meshes;
        for (const int node : nodes_)
            if (model_.nodes[node].mesh >= 0) meshes.insert(model_.nodes[node].mesh);
        for (const int mesh : meshes) decode_draco(file_, model_, mesh, accessors_);
    }

    [[nodiscard]] std::size_t most_bytes() const {
        if (options_.most_bytes != 0) return options_.most_bytes;
        return static_cast<std::size_t>(sysconf(_SC_PHYS_PAGES)) *
               static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
    }

    // About how much there is to compute for an instance of a node's mesh.
    [[nodiscard]] double steps_of(int node) const {
        const int skin = model_.nodes[node].skin;
        const auto joints = skin < 0 ? 0.0 : static_cast<double>(model_.skins[skin].joints.size());
        double steps = 0;
        for (const auto& primitive : model_.meshes[model_.nodes[node].mesh].primitives) {
            steps += 10 + joints;
            if (is_rendered(primitive))
                steps += static_cast<double>(
                             model_.accessors[primitive.attributes.at("POSITION")].count) *
                         static_cast<double>(1 + primitive.targets.size());
        }
        return steps;
    }

    struct Size {
        double vertices = 0, triangles = 0;
        [[nodiscard]] double bytes() const {
            return vertices * vertex_bytes + triangles * triangle_bytes;
        }
    };

    [[nodiscard]] Size size_of(int mesh) const {
        Size size;
        for (const auto& primitive : model_.meshes[mesh].primitives) {
            if (!is_rendered(primitive)) continue;
            const std::size_t count = model_.accessors[primitive.attributes.at("POSITION")].count;
            const std::size_t corners =
                primitive.indices < 0 ? count : model_.accessors[primitive.indices].count;
            size.vertices += static_cast<double>(count);
            size.triangles += static_cast<double>(is_list(primitive.mode) ? corners / 3 : corners);
        }
        return size;
    }

    [[nodiscard]] int material_of(const tinygltf::Primitive& primitive) const {
        return primitive.material >= 0 ? primitive.material
                                       : static_cast<int>(model_.materials.size());
    }

    // Whether it is the same wherever it stands, but for the transform, and gives no light.
    [[nodiscard]] bool is_rigid_and_dark(int mesh) const {
        return std::ranges::none_of(
            model_.meshes[mesh].primitives, [&](const tinygltf::Primitive& p) {
                const Material& m = scene_.materials[material_of(p)];
                return !p.targets.empty() ||
                       (glm::vec3(m.emission) != glm::vec3(0) && m.unlit == 0);
            });
    }

    // Which meshes are stored once: those of which copies take more than instances, if all such
    // copies together take much.
    void choose_shared() {
        is_shared_.assign(model_.meshes.size(), false);
        if (options_.storage == MeshStorage::copied) return;
        std::vector<double> places(model_.meshes.size(), 0);
        std::vector<bool> skinned(model_.meshes.size(), false);
        for (const int node : nodes_) {
            const int mesh = model_.nodes[node].mesh;
            if (mesh < 0) continue;
            places[mesh] += static_cast<double>(count_instances(file_, node));
            if (model_.nodes[node].skin >= 0) skinned[mesh] = true;
        }
        std::vector<bool> chosen = is_shared_;
        double all_saved = 0;
        for (std::size_t mesh = 0; mesh < places.size(); ++mesh) {
            if (places[mesh] < 2 || skinned[mesh]) continue;
            const double saved = (places[mesh] - 1) * size_of(static_cast<int>(mesh)).bytes() -
                                 places[mesh] * instance_bytes;
            if (saved <= 0 || !is_rigid_and_dark(static_cast<int>(mesh))) continue;
            chosen[mesh] = true;
            all_saved += saved;
        }
        if (options_.storage == MeshStorage::shared || all_saved > worth_sharing)
            is_shared_ = chosen;
    }

    // Finds how much is to be stored and computed: `copies` of a node's mesh.
    void count_copies(int node, double copies) {
        const Size size = size_of(model_.nodes[node].mesh);
        stored_.vertices += copies * size.vertices;
        stored_.triangles += copies * size.triangles;
        steps_ += copies * steps_of(node);
    }

    void count_all() {
        std::vector<bool> counted(model_.meshes.size(), false);
        for (const int node : nodes_) {
            const int mesh = model_.nodes[node].mesh;
            if (mesh < 0) continue;
            const auto places = static_cast<double>(count_instances(file_, node));
            steps_ += places;
            most_places_ = std::max(most_places_, places);
            if (!is_shared_[mesh]) {
                count_copies(node, places);
                continue;
            }
            if (!counted[mesh]) count_copies(node, 1);
            counted[mesh] = true;
            instances_ += places;
        }
        whole_ = stored_.vertices + stored_.triangles;
    }

    [[nodiscard]] double needed_bytes() const {
        return stored_.bytes() + instances_ * instance_bytes + most_places_ * place_bytes;
    }

    // Refuses scenes that cannot fit or take too long to read: a file of a kilobyte may ask for any
    // number of instances.
    void check_size() const {
        const auto most = static_cast<double>(most_bytes());
        const double bytes = needed_bytes();
        constexpr double gib = 1 << 30;
        if (bytes > most)
            throw InputError(
                "{}: its {:.0f} triangles and {:.0f} instances that share them need at least "
                "{:.1f} "
                "GiB, and there are {:.1f} GiB of memory",
                scene_.file, stored_.triangles, instances_, bytes / gib, most / gib);
        if (steps_ > most_steps)
            throw InputError(
                "{}: its instances, joints and morph targets make {:.3g} steps to load: more than "
                "{:.3g}",
                scene_.file, steps_, most_steps);
    }

    // One more vertex or triangle is there.
    void note_done() {
        constexpr std::size_t between = 1 << 18;
        if (++done_ % between == 0 && options_.report)
            options_.report(static_cast<double>(done_) / whole_);
    }

    void visit_node(int index) {
        const tinygltf::Node& node = model_.nodes[index];
        const glm::dmat4& to_world = pose_.to_world(index);
        check_transform(to_world, index);
        if (node.mesh >= 0) add_instances(index);
        if (node.camera >= 0) add_camera(index, to_world);
        const auto& light = extension(node.extensions, "KHR_lights_punctual");
        if (light.IsObject()) add_light(light.Get("light").GetNumberAsInt(), index, to_world);
    }

    void check_transform(const glm::dmat4& to_world, int node) const {
        for (int c = 0; c < 4; ++c)
            if (!(glm::compMax(glm::abs(to_world[c])) <= farthest))
                throw InputError("{}: nodes[{}]: its transform is out of range: {} is more than {}",
                                 scene_.file, node, glm::compMax(glm::abs(to_world[c])), farthest);
    }

    // A node's mesh wherever it is: a skinned one where its joints are, whatever the node.
    void add_instances(int node) {
        const bool skinned = model_.nodes[node].skin >= 0;
        const int mesh = model_.nodes[node].mesh;
        std::vector<glm::dmat4> places = mesh_instances(file_, node, accessors_);
        std::size_t copies = 0;
        const glm::dmat4 from_file = glm::translate(glm::dmat4(1), -scene_.origin);
        const glm::dmat4 to_file = glm::translate(glm::dmat4(1), scene_.origin);
        for (glm::dmat4& place : places) {
            place = skinned ? from_file * place * to_file : pose_.to_world(node) * place;
            check_transform(place, node);
            if (is_shared_[mesh] && !can_be_instance(mesh, glm::dmat3(place))) ++copies;
        }
        if (copies > 0) {  // which nobody has counted yet
            count_copies(node, static_cast<double>(copies));
            check_size();
        }
        for (const glm::dmat4& place : places) {
            if (!is_shared_[mesh] || !can_be_instance(mesh, glm::dmat3(place))) {
                add_mesh(node, place);
                continue;
            }
            scene_.instances.push_back(make_instance(glm::translate(place, centre_of(node))));
            scene_.instances.back().mesh = static_cast<std::uint32_t>(mesh);  // the file's, for now
        }
    }

    // Of a shared mesh, in its own frame: it is stored about that, for rays are rounded relative to
    // an instance's place.
    const glm::dvec3& centre_of(int node) {
        const int mesh = model_.nodes[node].mesh;
        const auto [found, is_new] = centres_.try_emplace(mesh, 0.0);
        if (!is_new) return found->second;
        Bounds bounds;
        const auto& primitives = model_.meshes[mesh].primitives;
        for (std::size_t p = 0; p < primitives.size(); ++p)
            if (is_rendered(primitives[p]))
                for (const glm::vec4& v : accessors_.vectors(
                         primitives[p].attributes.at("POSITION"), Attribute::position,
                         fmt::format("meshes[{}].primitives[{}].attributes.POSITION", mesh, p)))
                    bounds.add(glm::vec3(v));
        found->second = glm::dvec3(bounds.centre());
        return found->second;
    }

    // Whether single precision can take rays to a mesh's frame and normals back, and its triangles
    // face the same side there, if it matters.
    [[nodiscard]] bool can_be_instance(int mesh, const glm::dmat3& m) const {
        if (glm::determinant(m) < 0 &&
            std::ranges::any_of(model_.meshes[mesh].primitives, [&](const auto& primitive) {
                return scene_.materials[material_of(primitive)].culled != 0;
            }))
            return false;
        const auto norm = [](const glm::dmat3& a) {
            return std::sqrt(glm::dot(a[0], a[0]) + glm::dot(a[1], a[1]) + glm::dot(a[2], a[2]));
        };
        constexpr double most = 100;  // 3 where nothing is distorted
        const glm::dmat3 inverse = glm::inverse(m);
        return norm(m) * norm(inverse) < most && norm(m) < 1e6 && norm(inverse) < 1e6;
    }

    // Stores the meshes that have instances, behind all others, and completes these.
    void add_shared_meshes() {
        std::vector<std::uint32_t> numbers(model_.meshes.size(), ~0u);  // in the scene
        for (const int node : nodes_) {
            const int mesh = model_.nodes[node].mesh;
            if (mesh < 0 || !centres_.contains(mesh) || numbers[mesh] != ~0u) continue;
            numbers[mesh] = static_cast<std::uint32_t>(scene_.shared_meshes.size());
            const std::size_t vertices = scene_.vertices.size();
            const std::size_t triangles = scene_.triangle_count();
            add_mesh(node, glm::translate(glm::dmat4(1), -centre_of(node)));
            SharedMesh shared{static_cast<std::uint32_t>(triangles),
                              static_cast<std::uint32_t>(scene_.triangle_count() - triangles),
                              static_cast<std::uint32_t>(vertices),
                              static_cast<std::uint32_t>(scene_.vertices.size() - vertices),
                              {}};
            for (std::size_t v = vertices; v < scene_.vertices.size(); ++v)
                shared.bounds.add(scene_.vertices[v]);
            scene_.shared_meshes.push_back(shared);
        }
        std::size_t next = scene_.triangle_count();
        for (Instance& in : scene_.instances) {
            in.mesh = numbers[in.mesh];
            const SharedMesh& shared = scene_.shared_meshes[in.mesh];
            in.stored = shared.first_triangle;
            in.first = static_cast<std::uint32_t>(next);
            next += shared.triangle_count;
            if (next >= ~0u)
                throw InputError("{}: more than 2^32 triangles, instances counted one by one",
                                 scene_.file);
        }
        const Bounds bounds = scene_.bounds();
        if (!bounds.empty() && !(std::max(glm::compMax(glm::abs(bounds.lower)),
                                          glm::compMax(glm::abs(bounds.upper))) <= farthest))
            throw InputError("{}: an instance of a mesh is out of range in the world: more than {}",
                             scene_.file, farthest);
    }

    void add_camera(int index, const glm::dmat4& to_world) {
        const tinygltf::Node& node = model_.nodes[index];
        const tinygltf::Camera& camera = model_.cameras[node.camera];
        View view;
        view.name = !node.name.empty() ? node.name : camera.name;
        if (view.name.empty()) view.name = std::to_string(scene_.views.size());
        view.camera_name = camera.name;
        // Only place and direction count: scale, shear and mirroring are left out.
        const glm::dvec3 back = direction(to_world, {0, 0, 1});
        const glm::dvec3 right = glm::cross(direction(to_world, {0, 1, 0}), back);
        if (!(glm::length(right) > 1e-6))
            return notes_.add(fmt::format("nodes[{}]", index),
                              "is scaled to 0, which leaves no direction; its camera is left out");
        view.to_world[0] = glm::dvec4(glm::normalize(right), 0);
        view.to_world[1] = glm::dvec4(glm::cross(back, glm::normalize(right)), 0);
        view.to_world[2] = glm::dvec4(back, 0);
        view.to_world[3] = to_world[3];
        view.orthographic = camera.type == "orthographic";
        if (view.orthographic) {
            const double x = camera.orthographic.xmag;
            const double y = camera.orthographic.ymag;
            view.near = camera.orthographic.znear;
            view.far = camera.orthographic.zfar;
            view.aspect = std::abs(x / y);
            view.half_height = std::abs(y);
            if (x < 0) view.to_world[0] = -view.to_world[0];
            if (y < 0) view.to_world[1] = -view.to_world[1];
            if (x < 0 || y < 0)
                notes_.add(fmt::format("cameras[{}]", node.camera),
                           "has a negative xmag or ymag; its image is mirrored");
        } else {
            view.near = camera.perspective.znear;
            view.far = camera.perspective.zfar;
            view.aspect = std::max(camera.perspective.aspectRatio, 0.0);
            view.half_height = std::tan(camera.perspective.yfov / 2);
        }
        scene_.views.push_back(view);
    }

    void add_light(int index, int node, const glm::dmat4& to_world) {
        const tinygltf::Light& in = model_.lights[index];
        glm::vec3 color(1);
        if (in.color.size() == 3) color = glm::vec3(in.color[0], in.color[1], in.color[2]);
        color *= static_cast<float>(in.intensity * options_.lamp_scale);
        if (color == glm::vec3(0)) return;
        check_brightness(color,
                         fmt::format("KHR_lights_punctual.lights[{}]: color x intensity{}", index,
                                     options_.lamp_scale == 1 ? "" : " x --lamp-scale"));
        const bool is_point = in.type == "point";
        const glm::dvec3 shines = is_point ? glm::dvec3(0) : direction(to_world, {0, 0, -1});
        if (is_hidden(to_world) || (!is_point && shines == glm::dvec3(0)))
            return notes_.add(fmt::format("nodes[{}]", node),
                              "is scaled to 0; its light is hidden");
        const auto position = glm::vec3(glm::dvec3(to_world[3]));
        Light light{float4(position, LIGHT_POINT), float4(glm::vec3(shines), in.range), float4(0),
                    float4(color, 0)};
        if (in.type == "spot") {
            light.position.w = LIGHT_SPOT;
            light.edge = float4(spot_cone(in.spot.innerConeAngle, in.spot.outerConeAngle), 0, 0);
        } else if (in.type == "directional") {
            light.position.w = LIGHT_DIRECTIONAL;
            light.axis.w = 0;
        }
        scene_.lights.push_back(light);
        const std::string& name = model_.nodes[node].name;
        scene_.light_names.push_back(name.empty() ? in.name : name);
    }

    static bool is_lines_or_points(int mode) {
        return mode >= 0 && mode <= TINYGLTF_MODE_LINE_STRIP;
    }

    [[nodiscard]] bool is_empty(const tinygltf::Primitive& primitive) const {
        return model_.accessors[primitive.attributes.at("POSITION")].count == 0 ||
               (primitive.indices >= 0 && model_.accessors[primitive.indices].count == 0);
    }

    [[nodiscard]] bool is_rendered(const tinygltf::Primitive& primitive) const {
        return !is_lines_or_points(primitive.mode) && primitive.attributes.contains("POSITION") &&
               !is_empty(primitive);
    }

    static bool is_list(int mode) { return mode == TINYGLTF_MODE_TRIANGLES || mode == -1; }

    void add_mesh(int node, const glm::dmat4& to_world) {
        const int index = model_.nodes[node].mesh;
        for (std::size_t p = 0; p < model_.meshes[index].primitives.size(); ++p) {
            const auto& primitive = model_.meshes[index].primitives[p];
            const std::string where = fmt::format("meshes[{}].primitives[{}]", index, p);
            if (is_lines_or_points(primitive.mode)) {
                ++lines_and_points_;
                continue;
            }
            if (!primitive.attributes.contains("POSITION")) {
                ++without_position_;
                continue;
            }
            if (is_empty(primitive)) continue;
            add_primitive(primitive, where, node, to_world);
        }
    }

    void add_primitive(const tinygltf::Primitive& primitive, const std::string& where, int node,
                       const glm::dmat4& to_world) {
        const int accessor = primitive.attributes.at("POSITION");
        std::vector<glm::vec4> positions =
            accessors_.vectors(accessor, Attribute::position, where + ".attributes.POSITION");
        const std::size_t count = positions.size();
        add_targets(primitive, "POSITION", node, where, positions);
        std::vector<glm::vec4> normals =
            attribute(primitive, "NORMAL", Attribute::normal, count, where);
        has_normals_ = has_normals_ || !normals.empty();
        add_targets(primitive, "NORMAL", node, where, normals);
        std::vector<glm::dmat4> moved;  // [vertex] to the world
        if (model_.nodes[node].skin >= 0) moved = skin(primitive, node, count, where);
        const auto transform = [&](std::size_t v) -> glm::dmat4 {
            return moved.empty() ? to_world : to_world * moved[v];
        };
        const std::size_t base = scene_.vertices.size();
        if (base + count > 0xffffffffu)
            throw InputError("{}: {}: more than 2^32 vertices", scene_.file, where);
        glm::dmat4 m = transform(0);
        const bool mirrored = glm::determinant(glm::dmat3(m)) < 0;  // turns the winding round
        glm::dmat3 to_normal = glm::transpose(glm::inverse(glm::dmat3(m)));
        for (std::size_t v = 0; v < count; ++v) {
            note_done();
            if (!moved.empty()) {
                m = transform(v);
                to_normal = glm::transpose(glm::inverse(glm::dmat3(m)));
            }
            scene_.vertices.emplace_back(m * glm::dvec4(glm::vec3(positions[v]), 1));
            scene_.vertex_normals.emplace_back(
                normals.empty() ? glm::dvec3(0) : unit(to_normal * glm::dvec3(normals[v])));
            if (!(glm::compMax(glm::abs(scene_.vertices.back())) <= farthest))
                throw InputError(
                    "{}: {}.attributes.POSITION: vertex {} is out of range in the world: more than "
                    "{}",
                    scene_.file, where, v, farthest);
        }
        const int material = material_of(primitive);
        add_coordinates(primitive, material, count, where);
        add_tangents(primitive, material, node, transform, count, where);
        add_colors(primitive, count, where);
        add_triangles(corners(primitive, count, where), primitive.mode, base, mirrored, material);
    }

    // 0 where there is no direction.
    static glm::dvec3 unit(const glm::dvec3& v) {
        const double length = glm::length(v);
        return std::isfinite(length) && length > 0 ? v / length : glm::dvec3(0);
    }

    // An attribute of `count` vertices; none where the primitive does not have it.
    std::vector<glm::vec4> attribute(const tinygltf::Primitive& primitive, const std::string& name,
                                     Attribute kind, std::size_t count, const std::string& where) {
        const auto found = primitive.attributes.find(name);
        if (found == primitive.attributes.end()) return {};
        const std::string place = fmt::format("{}.attributes.{}", where, name);
        std::vector<glm::vec4> values = accessors_.vectors(found->second, kind, place);
        if (values.size() != count)
            throw InputError("{}: {}: {} values for {} positions", scene_.file, place,
                             values.size(), count);
        return values;
    }

    // Adds what the primitive's morph targets change of an attribute, by the node's weights.
    void add_targets(const tinygltf::Primitive& primitive, const std::string& name, int node,
                     const std::string& where, std::vector<glm::vec4>& values) {
        const std::span<const float> weights = pose_.morph_weights(node);
        for (std::size_t t = 0; t < std::min(primitive.targets.size(), weights.size()); ++t) {
            const auto found = primitive.targets[t].find(name);
            if (found == primitive.targets[t].end() || weights[t] == 0 || values.empty()) continue;
            const std::string place = fmt::format("{}.targets[{}].{}", where, t, name);
            const Attribute kind = name == "POSITION" ? Attribute::position : Attribute::normal;
            const std::vector<glm::vec4> change = accessors_.vectors(found->second, kind, place);
            if (change.size() != values.size())
                throw InputError("{}: {}: {} values for {} vertices", scene_.file, place,
                                 change.size(), values.size());
            for (std::size_t v = 0; v < values.size(); ++v)
                values[v] += glm::vec4(weights[t] * glm::vec3(change[v]), 0);
        }
    }

    // [vertex] the mean of its joints' matrices, to the world.
    std::vector<glm::dmat4> skin(const tinygltf::Primitive& primitive, int node, std::size_t count,
                                 const std::string& where) {
        const std::vector<glm::dmat4> joints =
            pose_.joint_matrices(model_.nodes[node].skin, accessors_);
        std::vector<glm::dmat4> out(count, glm::dmat4(0));
        std::vector<double> sums(count, 0);
        for (int set = 0; primitive.attributes.contains(fmt::format("JOINTS_{}", set)); ++set) {
            const std::string name = fmt::format("JOINTS_{}", set);
            const std::vector<glm::vec4> numbers =
                attribute(primitive, name, Attribute::joints, count, where);
            const std::vector<glm::vec4> weights = attribute(
                primitive, fmt::format("WEIGHTS_{}", set), Attribute::weights, count, where);
            for (std::size_t v = 0; v < weights.size(); ++v)
                for (int k = 0; k < 4; ++k) {
                    if (weights[v][k] == 0) continue;
                    const auto joint = static_cast<std::size_t>(numbers[v][k]);
                    if (joint >= joints.size())
                        throw InputError(
                            "{}: {}.attributes.{}: vertex {} has joint {}, but there are {}",
                            scene_.file, where, name, v, joint, joints.size());
                    out[v] += double{weights[v][k]} * joints[joint];
                    sums[v] += weights[v][k];
                }
        }
        for (std::size_t v = 0; v < count; ++v)
            out[v] = sums[v] > 0 ? out[v] / sums[v] : pose_.to_world(node);
        return out;
    }

    // Those that the scene's textures need; 0 where this primitive's do not.
    void add_coordinates(const tinygltf::Primitive& primitive, int material, std::size_t count,
                         const std::string& where) {
        for (std::size_t set = 0; set < coordinate_sets_.size(); ++set) {
            const std::string name = fmt::format("TEXCOORD_{}", coordinate_sets_[set]);
            std::vector<glm::vec2>& out = scene_.coordinates[set];
            if (!primitive.attributes.contains(name)) {
                if (needs_coordinates(material, set))
                    notes_.add(where, fmt::format("lacks {}, where its material has a texture; "
                                                  "0 0 is taken at all vertices",
                                                  name));
                out.resize(out.size() + count, glm::vec2(0));
                continue;
            }
            for (const glm::vec4& v :
                 attribute(primitive, name, Attribute::coordinates, count, where))
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
    template <class Transform>
    void add_tangents(const tinygltf::Primitive& primitive, int material, int node,
                      const Transform& transform, std::size_t count, const std::string& where) {
        const bool used = primitive.attributes.contains("TANGENT") && !scene_.maps.empty() &&
                          scene_.maps[MAP_KIND_COUNT * material + MAP_NORMAL].texture != NO_TEXTURE;
        if (!used) {
            if (!scene_.tangents.empty()) scene_.tangents.resize(scene_.vertices.size(), float4(0));
            return;
        }
        scene_.tangents.resize(scene_.vertices.size() - count, float4(0));
        std::vector<glm::vec4> tangents =
            attribute(primitive, "TANGENT", Attribute::tangent, count, where);
        add_targets(primitive, "TANGENT", node, where, tangents);
        for (std::size_t v = 0; v < count; ++v) {
            const glm::dmat3 linear(transform(v));
            const glm::vec3 along(unit(linear * glm::dvec3(tangents[v])));
            const float side = (tangents[v].w < 0) == (glm::determinant(linear) < 0) ? 1.f : -1.f;
            scene_.tangents.push_back(along == glm::vec3(0) ? float4(0) : float4(along, side));
        }
    }

    void add_colors(const tinygltf::Primitive& primitive, std::size_t count,
                    const std::string& where) {
        if (!primitive.attributes.contains("COLOR_0")) {
            if (!scene_.colors.empty()) scene_.colors.resize(scene_.vertices.size(), float4(1));
            return;
        }
        scene_.colors.resize(scene_.vertices.size() - count, float4(1));
        for (const glm::vec4& v : attribute(primitive, "COLOR_0", Attribute::color, count, where))
            scene_.colors.push_back(glm::clamp(v, 0.f, 1.f));
    }

    void add_triangles(const std::vector<std::uint32_t>& corners, int mode, std::size_t base,
                       bool mirrored, int material) {
        const bool list = is_list(mode);
        const std::size_t count = list                  ? corners.size() / 3
                                  : corners.size() >= 3 ? corners.size() - 2
                                                        : 0;
        for (std::size_t t = 0; t < count; ++t) {
            note_done();
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
            corners = accessors_.indices(primitive.indices, where + ".indices");
        }
        for (std::size_t i = 0; i < corners.size(); ++i)
            if (corners[i] >= vertices)
                throw InputError("{}: {}.indices: element {} is {}, but there are {} vertices",
                                 scene_.file, where, i, corners[i], vertices);
        if (is_list(primitive.mode) && corners.size() % 3 != 0)
            throw InputError("{}: {}: {} corners are no whole number of triangles", scene_.file,
                             where, corners.size());
        return corners;
    }

    void warn(std::size_t count, const char* what) {
        if (count > 0)
            scene_.warnings.push_back(fmt::format("{}: {} {}", scene_.file, count, what));
    }

    void note_what_is_not_rendered() {
        scene_.warnings = notes_.lines(scene_.file);
        const std::vector<std::string> more = accessors_.notes().lines(scene_.file);
        scene_.warnings.insert(scene_.warnings.end(), more.begin(), more.end());
        if (pose_.is_at_rest())
            warn(model_.animations.size(),
                 "animations are at rest; --at SECONDS shows a moment of the first");
        warn(lines_and_points_, "primitives are points or lines, which are not rendered");
        warn(without_position_, "primitives have no POSITION and are not rendered");
        std::set<std::string> names(model_.extensionsUsed.begin(), model_.extensionsUsed.end());
        names.insert(model_.extensionsRequired.begin(), model_.extensionsRequired.end());
        for (const std::string& name : names) {
            const Extension kind = extension_kind(name);
            if (kind != Extension::rendered && kind != Extension::silent)
                scene_.warnings.push_back(fmt::format(
                    "{}: extension {} is not rendered{}", scene_.file, name,
                    lets_light_through(name)
                        ? ": its surfaces are opaque, and block the light of lamps behind them"
                        : ""));
        }
    }

    const GltfFile& file_;
    tinygltf::Model model_;
    Accessors accessors_;
    Pose pose_;
    LoadOptions options_;
    Scene scene_;
    Notes notes_;
    std::vector<int> nodes_;
    std::vector<unsigned> coordinate_sets_;  // [set of Scene::coordinates] n of TEXCOORD_n
    std::map<int, glm::dvec3> centres_;      // of shared meshes that have instances
    std::vector<bool> is_shared_;            // [mesh] stored once
    Size stored_;                            // vertices and triangles, or what will be
    double instances_ = 0;                   // that share these
    double most_places_ = 0;                 // of a node, which are read at once
    double steps_ = 0;                       // of the loops that read them
    double whole_ = 0;                       // vertices and triangles that will be stored
    std::size_t done_ = 0;                   // of these
    bool has_normals_ = false;
    std::size_t lines_and_points_ = 0;
    std::size_t without_position_ = 0;
};

}  // namespace

Scene load_scene(const std::string& path, const LoadOptions& options) {
    GltfFile file = read_gltf(path);
    check_gltf(file);
    if (options.seconds) {
        point_animation(file, *options.seconds);
        check_gltf(file);
    }
    mend_gltf(file, options.variant);
    Scene scene = Loader(file, options, glm::dvec3(0)).load();
    const glm::dvec3 origin = find_origin(scene.bounds());
    if (origin == glm::dvec3(0)) return scene;
    scene = {};  // before another is loaded
    return Loader(file, options, origin).load();
}

}  // namespace manylight

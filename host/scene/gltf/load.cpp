// SPDX-License-Identifier: MIT
#include "scene/gltf/load.hpp"

#include <set>

#include "scene/alpha.hpp"
#include "scene/gltf/cameras_lights.hpp"
#include "scene/gltf/check.hpp"
#include "scene/gltf/draco.hpp"
#include "scene/gltf/extensions.hpp"
#include "scene/gltf/instances.hpp"
#include "scene/gltf/materials.hpp"
#include "scene/gltf/mend.hpp"
#include "scene/gltf/meshes.hpp"
#include "scene/gltf/storage.hpp"
#include "scene/gltf/textures.hpp"

namespace manylight {
namespace {

void decode_meshes(Loading& in) {
    std::set<int> meshes;
    for (const int node : in.nodes)
        if (in.model.nodes[node].mesh >= 0) meshes.insert(in.model.nodes[node].mesh);
    for (const int mesh : meshes) decode_draco(in.file, in.model, mesh, in.accessors);
}

void visit_node(Loading& in, int node, Instances& instances) {
    in.check_transform(in.pose.to_world(node), node);
    if (in.model.nodes[node].mesh >= 0) instances.add(node);
    if (in.model.nodes[node].camera >= 0) add_camera(in, node);
    add_light(in, node);
}

void warn(Scene& scene, std::size_t count, const char* what) {
    if (count > 0) scene.warnings.push_back(fmt::format("{}: {} {}", scene.file, count, what));
}

void note_what_is_not_rendered(Loading& in, const MeshReader& meshes) {
    Scene& scene = in.scene;
    scene.warnings = in.notes.lines(scene.file);
    const std::vector<std::string> more = in.accessors.notes().lines(scene.file);
    scene.warnings.insert(scene.warnings.end(), more.begin(), more.end());
    if (in.pose.is_at_rest())
        warn(scene, in.model.animations.size(),
             "animations are at rest; --at SECONDS shows a moment of the first");
    warn(scene, meshes.lines_and_points(),
         "primitives are points or lines, which are not rendered");
    warn(scene, meshes.without_position(), "primitives have no POSITION and are not rendered");
    std::set<std::string> names(in.model.extensionsUsed.begin(), in.model.extensionsUsed.end());
    names.insert(in.model.extensionsRequired.begin(), in.model.extensionsRequired.end());
    for (const std::string& name : names) {
        const Extension kind = extension_kind(name);
        if (kind != Extension::rendered && kind != Extension::silent)
            scene.warnings.push_back(fmt::format(
                "{}: extension {} is not rendered{}", scene.file, name,
                lets_light_through(name)
                    ? ": its surfaces are opaque, and block the light of lamps behind them"
                    : ""));
    }
}

Scene load_about(const glm::dvec3& origin, const GltfFile& file, const LoadOptions& options) {
    Loading in(file, options, origin);
    add_materials(in);
    Storage storage(in);
    std::vector<unsigned> coordinate_sets = load_textures(file, in.model, used_materials(in.model),
                                                          storage.bytes_left(), in.scene, in.notes);
    limit_reflectance(in.scene);
    decode_meshes(in);
    MeshReader meshes(in, std::move(coordinate_sets), storage.expected());
    Instances instances(in, storage, meshes);
    for (const int node : in.nodes) visit_node(in, node, instances);
    instances.add_shared_meshes();
    find_alpha(in.scene);
    note_what_is_not_rendered(in, meshes);
    if (!meshes.has_normals()) in.scene.vertex_normals = {};
    return std::move(in.scene);
}

}  // namespace

Scene load_scene(const std::string& path, const LoadOptions& options) {
    GltfFile file = read_gltf(path);
    check_gltf(file);
    if (options.seconds) {
        point_animation(file, *options.seconds);
        check_gltf(file);
    }
    mend_gltf(file, options.variant);
    Scene scene = load_about(glm::dvec3(0), file, options);
    const glm::dvec3 origin = find_origin(scene.bounds());
    if (origin == glm::dvec3(0)) return scene;
    scene = {};  // before another is loaded
    return load_about(origin, file, options);
}

}  // namespace manylight

// SPDX-License-Identifier: MIT
#include "scene/scene.hpp"

#define GLM_ENABLE_EXPERIMENTAL
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtx/component_wise.hpp>

#include "error.hpp"

namespace manylight {
namespace {

View frame_all(const Bounds& bounds) {
    constexpr double yfov = 0.7;
    const glm::dvec3 centre = bounds.centre();
    const double radius = std::max(static_cast<double>(bounds.radius()), 1e-3);
    const double distance = 1.05 * radius / std::sin(yfov / 2);
    const glm::dvec3 eye = centre + distance * glm::normalize(glm::dvec3(0.35, 0.3, 1.0));
    View view;
    view.name = "framed";
    view.to_world = glm::inverse(glm::lookAt(eye, centre, glm::dvec3(0, 1, 0)));
    view.half_height = std::tan(yfov / 2);
    return view;
}

}  // namespace

Instance make_instance(const glm::dmat4& to_world) {
    Instance in{};
    const glm::mat4 rows(glm::transpose(to_world));
    for (int k = 0; k < 3; ++k) in.to_world[k] = rows[k];
    const glm::dmat3 linear = glm::transpose(
        glm::dmat3(glm::dvec3(rows[0]), glm::dvec3(rows[1]), glm::dvec3(rows[2])));
    const glm::dmat3 inverse = glm::transpose(glm::inverse(linear));
    for (int k = 0; k < 3; ++k) in.to_object[k] = float4(glm::vec3(inverse[k]), 0);
    in.mirrored = glm::determinant(linear) < 0 ? 1 : 0;
    return in;
}

bool has_map(const Scene& scene, std::size_t material, MapKind kind) {
    return !scene.maps.empty() &&
           scene.maps[MAP_KIND_COUNT * material + kind].texture != NO_TEXTURE;
}

std::size_t Scene::seen_triangle_count() const {
    std::size_t count = own_triangle_count();
    for (const Instance& in : instances) count += shared_meshes[in.mesh].triangle_count;
    return count;
}

Bounds Scene::bounds() const {
    const std::size_t own =
        shared_meshes.empty() ? vertices.size() : shared_meshes.front().first_vertex;
    Bounds bounds;
    for (std::size_t v = 0; v < own; ++v) bounds.add(vertices[v]);
    for (const Instance& in : instances) {
        const SharedMesh& mesh = shared_meshes[in.mesh];
        Bounds with_box = bounds;
        for (int k = 0; k < 8; ++k) with_box.add(point_to_world(in, mesh.bounds.corner(k)));
        if (with_box.lower == bounds.lower && with_box.upper == bounds.upper) continue;
        for (std::size_t v = 0; v < mesh.vertex_count; ++v)
            bounds.add(point_to_world(in, vertices[mesh.first_vertex + v]));
    }
    return bounds;
}

Features find_features(const Scene& scene) {
    Features features;
    for (const Light& light : scene.lights)
        features.kinds[static_cast<std::size_t>(light.position.w)] = true;
    std::vector<bool> used(scene.materials.size(), false);
    for (const std::uint32_t material : scene.triangle_materials) used[material] = true;
    for (std::size_t i = 0; i < scene.materials.size(); ++i) {
        if (!used[i]) continue;
        const Material& material = scene.materials[i];
        if (material.base_color.w > 0 || material.specular > 0) features.ggx = true;
        if (glm::vec3(material.emission) != glm::vec3(0)) features.emission = true;
        if (has_map(scene, i, MAP_SPECULAR) || has_map(scene, i, MAP_SPECULAR_COLOR))
            features.specular_maps = true;
        if (material.base_color.w > 0 || material.specular > 0)
            features.reflections |= (material.roughness < REFLECTING_ALPHA ||
                                     has_map(scene, i, MAP_METALLIC_ROUGHNESS)) &&
                                    !scene.cell_areas.empty();
    }
    features.smooth = !scene.vertex_normals.empty();
    features.textures = !scene.maps.empty();
    features.colors = !scene.colors.empty();
    features.tangents = !scene.tangents.empty();
    features.alpha = !scene.alpha_triangles.empty();
    features.instances = !scene.instances.empty();
    return features;
}

glm::dvec3 find_origin(const Bounds& bounds) {
    if (bounds.empty()) return glm::dvec3(0);
    const glm::dvec3 lower(bounds.lower);
    const glm::dvec3 upper(bounds.upper);
    const double side = glm::compMax(upper - lower);
    if (!(glm::compMax(glm::max(lower, -upper)) > 16 * side)) return glm::dvec3(0);
    const double unit = std::exp2(std::ceil(std::log2(std::max(side, 1e-3))));
    return glm::round((lower + upper) / 2.0 / unit) * unit;
}

View find_view(const Scene& scene, const std::string& name) {
    if (name.empty()) return scene.views.empty() ? frame_all(scene.bounds()) : scene.views.front();
    std::string names;
    for (const View& view : scene.views) {
        if (view.name == name || view.camera_name == name) return view;
        names += fmt::format("{}'{}'", names.empty() ? "" : ", ", view.name);
    }
    throw InputError("{}: --camera {}: no such camera (there are: {})", scene.file, name,
                     names.empty() ? "none" : names);
}

Camera make_camera(const View& view, unsigned width, unsigned height,
                   std::pair<double, double> shift) {
    const double aspect = static_cast<double>(width) / height;
    const auto vector = [&](const glm::dvec4& v, double w) {
        return float4(glm::vec3(glm::dvec3(v)), static_cast<float>(w));
    };
    const glm::dvec4 right = view.to_world[0] * (view.half_height * aspect);
    const glm::dvec4 up = view.to_world[1] * view.half_height;
    const glm::dvec4 aside = right * (2 * shift.first / width) - up * (2 * shift.second / height);
    const glm::dvec4 none(0);
    Camera camera;
    camera.origin = vector(view.to_world[3] + (view.orthographic ? aside : none), 0);
    camera.right = vector(right, 0);
    camera.up = vector(up, 0);
    camera.forward =
        vector((view.orthographic ? none : aside) - view.to_world[2], view.orthographic ? 1 : 0);
    return camera;
}

}  // namespace manylight

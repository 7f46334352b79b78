// SPDX-License-Identifier: MIT
#include "scene/scene.hpp"

#define GLM_ENABLE_EXPERIMENTAL
#include <algorithm>
#include <array>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtx/component_wise.hpp>

#include "error.hpp"

namespace manylight {
namespace {

// The vertices of triangles, where they are seen.
class SeenVertices {
  public:
    explicit SeenVertices(const Scene& scene) : scene_(scene), used_(scene.vertices.size()) {
        for (const std::uint32_t vertex : scene.indices) used_[vertex] = true;
    }

    // The one of the largest score, a linear function of the place or a ratio of two.
    template <class Score>
    [[nodiscard]] glm::dvec3 farthest(const Score& score) const {
        double most = -std::numeric_limits<double>::infinity();
        glm::dvec3 out(0);
        const auto exceeds = [&](const glm::dvec3& p) { return score(p) > most; };
        const auto add = [&](const glm::dvec3& p) {
            if (!exceeds(p)) return;
            most = score(p);
            out = p;
        };
        const std::size_t own = scene_.shared_meshes.empty()
                                    ? scene_.vertices.size()
                                    : scene_.shared_meshes.front().first_vertex;
        for (std::size_t v = 0; v < own; ++v)
            if (used_[v]) add(scene_.vertices[v]);
        for (const Instance& in : scene_.instances) {
            const SharedMesh& mesh = scene_.shared_meshes[in.mesh];
            bool may_exceed = false;
            for (int k = 0; k < 8; ++k)
                may_exceed |= exceeds(point_to_world(in, mesh.bounds.corner(k)));
            if (!may_exceed) continue;
            for (std::size_t v = mesh.first_vertex; v < mesh.first_vertex + mesh.vertex_count; ++v)
                if (used_[v]) add(point_to_world(in, scene_.vertices[v]));
        }
        return out;
    }

    [[nodiscard]] double reach(const glm::dvec3& direction) const {
        const auto along = [&](const glm::dvec3& p) { return glm::dot(p, direction); };
        return along(farthest(along));
    }

    // Where along `side` an eye is, `back` behind, from which all is as far to this side of the
    // image's middle as to the other.
    [[nodiscard]] double middle(const glm::dvec3& side, const glm::dvec3& back, double eye_back,
                                double start) const {
        double middle = start;
        for (int i = 0; i < 8; ++i) {
            const auto depth = [&](const glm::dvec3& p) { return eye_back - glm::dot(p, back); };
            // A corner of an instance's box may be behind the eye.
            const auto off = [&](const glm::dvec3& p, double sign) {
                return depth(p) > 0 ? sign * (glm::dot(p, side) - middle) / depth(p)
                                    : std::numeric_limits<double>::infinity();
            };
            const glm::dvec3 a = farthest([&](const glm::dvec3& p) { return off(p, 1); });
            const glm::dvec3 b = farthest([&](const glm::dvec3& p) { return off(p, -1); });
            // From there, these two are: (a - middle) / depth(a) = (middle - b) / depth(b).
            const double next = (glm::dot(a, side) * depth(b) + glm::dot(b, side) * depth(a)) /
                                (depth(a) + depth(b));
            if (next == middle) break;
            middle = next;
        }
        return middle;
    }

  private:
    const Scene& scene_;
    std::vector<bool> used_;
};

// The share of the image, along its width or its height, that a framed scene fills.
constexpr double filled = 0.85;

// From the front, above and right, as near as all triangles are in the filled part of the image.
View frame_all(const Scene& scene, double aspect) {
    View view;
    view.name = "framed";
    view.half_height = std::tan(0.35);
    const glm::dvec3 back = glm::normalize(glm::dvec3(0.35, 0.3, 1.0));
    const glm::dvec3 right = glm::normalize(glm::cross(glm::dvec3(0, 1, 0), back));
    const glm::dvec3 up = glm::cross(back, right);
    glm::dvec3 eye(0, 0, 1);  // along right, up and back
    if (scene.seen_triangle_count() > 0) {
        const SeenVertices seen(scene);
        // A point p is in the filled part of what is seen from e where, for each side of the image,
        // dot(p, side + half back) <= dot(e, side + half back).
        const double half_height = filled * view.half_height;
        const double half_width = half_height * aspect;
        const double r = seen.reach(right + half_width * back);
        const double l = seen.reach(half_width * back - right);
        const double u = seen.reach(up + half_height * back);
        const double d = seen.reach(half_height * back - up);
        // All may be on a line through the eye, or a point.
        const double size = scene.bounds().radius();
        eye.z = std::max({(r + l) / (2 * half_width), (u + d) / (2 * half_height),
                          seen.reach(back) + (size > 0 ? 1e-3 * size : 1)});
        eye.x = seen.middle(right, back, eye.z, (r - l) / 2);
        eye.y = seen.middle(up, back, eye.z, (u - d) / 2);
    }
    view.to_world = {glm::dvec4(right, 0), glm::dvec4(up, 0), glm::dvec4(back, 0),
                     glm::dvec4(eye.x * right + eye.y * up + eye.z * back, 1)};
    return view;
}

}  // namespace

Instance make_instance(const glm::dmat4& to_world) {
    Instance in{};
    const glm::mat4 rows(glm::transpose(to_world));
    for (int k = 0; k < 3; ++k) in.to_world[k] = rows[k];
    const glm::dmat3 linear =
        glm::transpose(glm::dmat3(glm::dvec3(rows[0]), glm::dvec3(rows[1]), glm::dvec3(rows[2])));
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
                                    !scene.light_cells.empty();
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

glm::vec2 spot_cone(double inner, double outer) {
    // Differences of cosines near 1, without cancellation.
    const double half = std::sin(outer / 2);
    const double fade = 2 * std::sin((outer + inner) / 2) * std::sin((outer - inner) / 2);
    constexpr double sharp = 1e30;
    return {std::min(1 / std::max(fade, 0.0), sharp), 2 * half * half};
}

View find_view(const Scene& scene, const std::string& name, double aspect) {
    if (name.empty()) return scene.views.empty() ? frame_all(scene, aspect) : scene.views.front();
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
    camera.right = vector(right, view.near);
    camera.up = vector(up, view.far);
    camera.forward =
        vector((view.orthographic ? none : aside) - view.to_world[2], view.orthographic ? 1 : 0);
    return camera;
}

}  // namespace manylight

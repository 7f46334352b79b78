// SPDX-License-Identifier: MIT
#include <cmath>
#include <glm/gtc/constants.hpp>

#include "error.hpp"
#include "print.hpp"
#include "scene/builtin/builtin.hpp"
#include "scene/gltf/load.hpp"
#include "scene/scene.hpp"

namespace manylight {
namespace {

constexpr float tau = glm::two_pi<float>();

// A point of a (2, 3) torus knot's tube, with ridges and scales: u along, v around, both in turns.
glm::vec3 knot(float u, float v) {
    const auto centre = [](float t) {
        const float r = 0.6f + 0.25f * std::cos(3 * tau * t);
        return glm::vec3(r * std::cos(2 * tau * t), 0.25f * std::sin(3 * tau * t),
                         r * std::sin(2 * tau * t));
    };
    const glm::vec3 c = centre(u);
    const glm::vec3 along = glm::normalize(centre(u + 1e-3f) - centre(u - 1e-3f));
    const glm::vec3 side = glm::normalize(glm::cross(along, glm::vec3(0, 1, 0)));
    const glm::vec3 up = glm::cross(side, along);
    const float ridge = 0.012f * std::pow(std::abs(std::cos(tau * 3 * v)), 8.0f);
    const float scales = 0.006f * std::sin(tau * 220 * u) * std::sin(tau * 24 * v);
    const float radius = 0.12f + 0.02f * std::sin(tau * 9 * u) + ridge + scales;
    return c + radius * (std::cos(tau * v) * side + std::sin(tau * v) * up);
}

// Half a million triangles with smooth normals.
Mesh make_knot() {
    constexpr unsigned nu = 2400;
    constexpr unsigned nv = 120;
    Mesh mesh;
    for (unsigned i = 0; i < nu; ++i)
        for (unsigned j = 0; j < nv; ++j) {
            const float u = static_cast<float>(i) / nu;
            const float v = static_cast<float>(j) / nv;
            mesh.positions.push_back(knot(u, v));
            const glm::vec3 du = knot(u + 1e-4f, v) - knot(u - 1e-4f, v);
            const glm::vec3 dv = knot(u, v + 1e-3f) - knot(u, v - 1e-3f);
            mesh.normals.push_back(glm::normalize(glm::cross(dv, du)));
            const unsigned in = (i + 1) % nu;
            const unsigned jn = (j + 1) % nv;
            for (const unsigned k :
                 {i * nv + j, i * nv + jn, in * nv + jn, i * nv + j, in * nv + jn, in * nv + j})
                mesh.indices.push_back(k);
        }
    return mesh;
}

// All triangles of a glTF file.
Mesh read_mesh(const std::string& path) {
    const Scene scene = load_scene(path, {.storage = MeshStorage::copied});
    for (const std::string& warning : scene.warnings) warn("{}", warning);
    const Bounds bounds = scene.bounds();
    if (scene.triangle_count() == 0 || !(bounds.radius() > 1e-6f * glm::length(bounds.centre())))
        throw InputError("--mesh {}: has no triangles, or none with an extent", path);
    return {scene.vertices, scene.vertex_normals, scene.indices};
}

// Scales and moves a mesh to stand on the floor, centred, `size` m at its largest.
void place(Mesh& mesh, float size) {
    Bounds bounds;
    for (const glm::vec3 p : mesh.positions) bounds.add(p);
    const glm::vec3 extent = bounds.upper - bounds.lower;
    const float scale = size / std::max({extent.x, extent.y, extent.z});
    const glm::vec3 foot(bounds.centre().x, bounds.lower.y, bounds.centre().z);
    for (glm::vec3& p : mesh.positions) p = (p - foot) * scale;
}

}  // namespace

void make_dragon(GltfWriter& out, const BuiltinOptions& options) {
    Mesh object = options.mesh.empty() ? make_knot() : read_mesh(options.mesh);
    place(object, 1.7f);
    Mesh grey;
    grey.add_quad({-1.5f, 0, 1.5f}, {3, 0, 0}, {0, 0, -3});
    grey.add_quad({-1.5f, 2.4f, -1.5f}, {3, 0, 0}, {0, 0, 3});
    grey.add_quad({-1.5f, 0, -1.5f}, {3, 0, 0}, {0, 2.4f, 0});
    Mesh left;
    left.add_quad({-1.5f, 0, 1.5f}, {0, 0, -3}, {0, 2.4f, 0});
    Mesh right;
    right.add_quad({1.5f, 0, -1.5f}, {0, 0, 3}, {0, 2.4f, 0});
    out.add_mesh("object", object, out.add_material({0.6f, 0.55f, 0.35f}, 0, 0.35f));
    out.add_mesh("room", grey, out.add_diffuse({0.7f, 0.7f, 0.7f}));
    out.add_mesh("left", left, out.add_diffuse({0.6f, 0.25f, 0.2f}));
    out.add_mesh("right", right, out.add_diffuse({0.2f, 0.3f, 0.6f}));
    const glm::vec3 colors[] = {{10, 8.5f, 6}, {10, 3.5f, 2}, {3, 5.5f, 10}, {4.5f, 9, 4}};
    const glm::vec2 corners[] = {{-0.25f, -0.3f}, {-1.3f, -1.2f}, {0.8f, -1.2f}, {0.8f, 0.7f}};
    for (int i = 0; i < 4; ++i) {
        Mesh light;
        light.add_quad({corners[i].x, 2.38f, corners[i].y}, {0.5f, 0, 0}, {0, 0, 0.5f});
        out.add_mesh("light", light, out.add_emitter(colors[i]));
    }
    out.add_camera("far", {0, 1, 4.4f}, {0, 0.75f, 0}, 0.6f, 1);
    out.add_camera("close", {0.1f, 0.8f, 1.5f}, {0, 0.5f, 0}, 0.6f, 1);
    out.set_emitter_points(100);
}

}  // namespace manylight

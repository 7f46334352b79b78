// SPDX-License-Identifier: MIT
// Scenes part by part.
#pragma once

#include "scene/gltf/writer.hpp"
#include "scene/scene.hpp"

namespace manylight {

/// Lambert's material of that colour.
[[nodiscard]] Material diffuse(glm::vec3 color);
/// What glTF's metallic-roughness material is; `alpha` is GGX's.
[[nodiscard]] Material glossy(glm::vec3 color, float metallic, float alpha);
/// Black, with that radiance, cd/m2.
[[nodiscard]] Material emitter(glm::vec3 radiance, bool both_sides = false);

[[nodiscard]] Light point_light(glm::vec3 position, glm::vec3 intensity, float range = 0);
/// Angles in radians.
[[nodiscard]] Light spot_light(glm::vec3 position, glm::vec3 direction, glm::vec3 intensity,
                               float inner, float outer, float range = 0);
[[nodiscard]] Light directional_light(glm::vec3 direction, glm::vec3 illuminance);
/// From the plane through `place` on.
[[nodiscard]] Light directional_light_from(glm::vec3 place, glm::vec3 direction,
                                           glm::vec3 illuminance);
[[nodiscard]] Light oriented_light(glm::vec3 position, glm::vec3 normal, glm::vec3 intensity);

/// A ball with vertex normals.
[[nodiscard]] Mesh make_ball(glm::vec3 centre, float radius, int rings = 10);

[[nodiscard]] View look(glm::dvec3 eye, glm::dvec3 target, double yfov);

class SceneMaker {
  public:
    /// Returns its index.
    std::uint32_t add(const Material& material);
    void add(const Mesh& mesh, std::uint32_t material);
    void add(const Light& light) { scene_.lights.push_back(light); }
    /// The mesh is stored once and stands where the matrices say; after all add() of meshes.
    void add_shared(const Mesh& mesh, std::uint32_t material, const std::vector<glm::mat4>& places);
    /// Two sets of texture coordinates, by the vertices' positions, in metres; after all meshes.
    void spread_coordinates();
    /// A texture of some seven colours, `scale` times to the metre. `kind` % 3 is its wrap.
    void add_map(std::uint32_t material, MapKind kind, TexelFormat format, TextureLevels levels,
                 float scale, bool linear);
    Scene& scene() { return scene_; }
    /// Completes alpha, lights and powers.
    [[nodiscard]] Scene finish();

  private:
    Scene scene_;
};

}  // namespace manylight

// SPDX-License-Identifier: MIT
#pragma once

#include <glm/glm.hpp>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace manylight {

/// A triangle mesh in the making, world space; faces are counter-clockwise seen from outside.
struct Mesh {
    std::vector<glm::vec3> positions;
    std::vector<glm::vec3> normals;  // empty: flat
    std::vector<std::uint32_t> indices;

    /// The parallelogram with corner `corner` that faces cross(u, v).
    void add_quad(glm::vec3 corner, glm::vec3 u, glm::vec3 v);
    /// Walls behind, to the left and to the right of a square floor from -half to half, facing in.
    void add_walls(float half, float height);
    /// The box that stands on `centre`, facing outwards, turned by `angle` radians about y.
    void add_box(glm::vec3 centre, glm::vec3 size, float angle = 0);
    /// A triangle that faces cross(b - a, c - a).
    void add_triangle(glm::vec3 a, glm::vec3 b, glm::vec3 c);
};

/// Builds a glTF 2.0 scene and writes it as .glb.
class GltfWriter {
  public:
    GltfWriter();

    /// Lambert's material of that colour; returns its index.
    int add_diffuse(glm::vec3 color);
    /// A metallic-roughness material.
    int add_material(glm::vec3 color, float metallic, float roughness);
    /// A black emitter of that radiance, cd/m2, on its front side.
    int add_emitter(glm::vec3 radiance);

    void add_mesh(const std::string& name, const Mesh& mesh, int material);
    /// A mesh that stands where nodes say; returns its index.
    int add_shape(const std::string& name, const Mesh& mesh, int material);
    void add_node(const std::string& name, int shape, const glm::mat4& to_world);
    /// Intensity in cd, towards all sides.
    void add_point(glm::vec3 position, glm::vec3 intensity);
    /// Intensity in cd, about `direction`; angles in radians.
    void add_spot(glm::vec3 position, glm::vec3 direction, glm::vec3 intensity, float inner,
                  float outer);
    /// Illuminance in lx.
    void add_directional(glm::vec3 direction, glm::vec3 illuminance);
    /// A perspective camera; yfov in radians. Its near plane is at 1 cm, or nearer where the target
    /// is nearer than 1 m.
    void add_camera(const std::string& name, glm::vec3 eye, glm::vec3 target, float yfov,
                    float aspect);
    /// The number of oriented points that the emitters are meant to be rendered with.
    void set_emitter_points(unsigned points);

    /// See write_file(). Throws RuntimeError.
    void write(const std::string& path) const;

  private:
    int add_accessor(const void* data, std::size_t bytes, std::size_t count, int component,
                     const char* type, int target);
    void add_light(nlohmann::json light, glm::vec3 position, glm::vec3 direction);
    void use(const char* extension);

    nlohmann::json json_;
    std::vector<char> binary_;
};

}  // namespace manylight

// SPDX-License-Identifier: MIT
#pragma once

#include "scene/gltf/loading.hpp"

namespace manylight {

/// Reads the vertices and triangles of meshes: morphed, skinned and taken to the world.
class MeshReader {
  public:
    /// The scene has its materials, maps and as many sets of coordinates as `coordinate_sets`: the
    /// n of the TEXCOORD_n that each holds. `expected`: vertices and triangles that there will be.
    MeshReader(Loading& in, std::vector<unsigned> coordinate_sets, double expected);

    /// Adds a node's mesh. Throws InputError.
    void add(int node, const glm::dmat4& to_world);

    /// Of all that was added.
    [[nodiscard]] bool has_normals() const { return has_normals_; }
    [[nodiscard]] std::size_t lines_and_points() const { return lines_and_points_; }  // primitives
    [[nodiscard]] std::size_t without_position() const { return without_position_; }  // likewise

  private:
    using Transform = std::function<glm::dmat4(std::size_t vertex)>;  // to the world

    void note_done();
    void add_primitive(const tinygltf::Primitive& primitive, const std::string& where, int node,
                       const glm::dmat4& to_world);
    [[nodiscard]] std::vector<glm::vec4> attribute(const tinygltf::Primitive& primitive,
                                                   const std::string& name, Attribute kind,
                                                   std::size_t count, const std::string& where);
    void add_targets(const tinygltf::Primitive& primitive, const std::string& name, int node,
                     const std::string& where, std::vector<glm::vec4>& values);
    [[nodiscard]] std::vector<glm::dmat4> skin(const tinygltf::Primitive& primitive, int node,
                                               std::size_t count, const std::string& where);
    void add_coordinates(const tinygltf::Primitive& primitive, int material, std::size_t count,
                         const std::string& where);
    [[nodiscard]] bool needs_coordinates(int material, std::size_t set) const;
    void add_tangents(const tinygltf::Primitive& primitive, int material, int node,
                      const Transform& transform, std::size_t count, const std::string& where);
    void add_colors(const tinygltf::Primitive& primitive, std::size_t count,
                    const std::string& where);
    void add_triangles(const std::vector<std::uint32_t>& corners, int mode, std::size_t base,
                       bool mirrored, int material);
    [[nodiscard]] std::vector<std::uint32_t> corners(const tinygltf::Primitive& primitive,
                                                     std::size_t vertices,
                                                     const std::string& where);

    Loading& in_;
    Scene& scene_;
    std::vector<unsigned> coordinate_sets_;
    double expected_;
    std::size_t done_ = 0;  // of these
    bool has_normals_ = false;
    std::size_t lines_and_points_ = 0;
    std::size_t without_position_ = 0;
};

}  // namespace manylight

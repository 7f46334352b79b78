// SPDX-License-Identifier: MIT
#pragma once

#include <glm/glm.hpp>

#include "scene/scene.hpp"

namespace manylight::reference {

/// A scene's triangle as it stands in the world, in double precision; one of an instance by the
/// instance's matrix to the world alone.
class Triangle {
  public:
    Triangle(const Scene& scene, uint triangle);

    [[nodiscard]] uint material() const { return scene_.triangle_materials[stored_]; }
    /// Corner k's vertex: an index in the scene's arrays.
    [[nodiscard]] uint vertex(int k) const { return scene_.indices[3 * std::size_t{stored_} + k]; }
    /// Where corner k is, m.
    [[nodiscard]] glm::dvec3 corner(int k) const;
    /// Normal on the side that the winding faces; its length is twice the area, m2.
    [[nodiscard]] glm::dvec3 face() const;
    /// Of corner k's vertex; unit, or 0 where it has none.
    [[nodiscard]] glm::dvec3 normal(int k) const;
    /// xyz: unit; w: as in glTF; 0 where it has none.
    [[nodiscard]] glm::dvec4 tangent(int k) const;
    /// How the area light that it is is cut to cells; none where it is none.
    [[nodiscard]] const CellGrid* cells() const;
    /// Corner k as it is stored, in the frame of its mesh.
    [[nodiscard]] glm::dvec3 stored_corner(int k) const;
    [[nodiscard]] bool is_of_instance() const { return instance_ != nullptr; }
    /// Of the instance that it is of, or the identity and 0: a point p of the world is
    /// to_mesh() * (p - place()) in the frame of its mesh.
    [[nodiscard]] glm::dmat3 to_mesh() const;
    [[nodiscard]] glm::dvec3 place() const;
    /// By how much, in units of single precision, the way to the mesh's frame and back moves its
    /// points along each axis, as in OFFSET_SCALE; 0 where it is of no instance.
    [[nodiscard]] glm::dvec3 frame_rounding() const;

  private:
    const Scene& scene_;
    const Instance* instance_ = nullptr;
    uint stored_;
};

}  // namespace manylight::reference

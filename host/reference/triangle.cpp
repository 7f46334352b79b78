// SPDX-License-Identifier: MIT
#include "reference/triangle.hpp"

#include <algorithm>

namespace manylight::reference {
namespace {

glm::dmat3 linear_part(const Instance& in) {
    return glm::transpose(glm::dmat3(glm::dvec3(in.to_world[0]), glm::dvec3(in.to_world[1]),
                                     glm::dvec3(in.to_world[2])));
}

glm::dvec3 place_of(const Instance& in) {
    return {in.to_world[0].w, in.to_world[1].w, in.to_world[2].w};
}

glm::dvec3 unit_or_none(const glm::dvec3& v) {
    return glm::length(v) > 0 ? glm::normalize(v) : glm::dvec3(0);
}

glm::dmat3 sizes(const glm::dmat3& m) { return {glm::abs(m[0]), glm::abs(m[1]), glm::abs(m[2])}; }

}  // namespace

Triangle::Triangle(const Scene& scene, uint triangle) : scene_(scene), stored_(triangle) {
    if (triangle < scene.triangle_count()) return;
    const auto behind = std::ranges::upper_bound(scene.instances, triangle, {},
                                                 [](const auto& in) { return in.first; });
    instance_ = &*std::prev(behind);
    stored_ = instance_->stored + (triangle - instance_->first);
}

glm::dvec3 Triangle::corner(int k) const {
    const glm::dvec3 v(scene_.vertices[vertex(k)]);
    return instance_ ? linear_part(*instance_) * v + place_of(*instance_) : v;
}

glm::dvec3 Triangle::face() const {
    const glm::dvec3 n = glm::cross(corner(1) - corner(0), corner(2) - corner(0));
    return instance_ && glm::determinant(linear_part(*instance_)) < 0 ? -n : n;
}

glm::dvec3 Triangle::normal(int k) const {
    if (scene_.vertex_normals.empty()) return glm::dvec3(0);
    const glm::dvec3 n(scene_.vertex_normals[vertex(k)]);
    if (!instance_) return n;
    return unit_or_none(glm::transpose(glm::inverse(linear_part(*instance_))) * n);
}

glm::dvec4 Triangle::tangent(int k) const {
    if (scene_.tangents.empty()) return glm::dvec4(0);
    const glm::dvec4 t(scene_.tangents[vertex(k)]);
    if (!instance_) return t;
    const glm::dmat3 linear = linear_part(*instance_);
    return glm::dvec4(unit_or_none(linear * glm::dvec3(t)),
                      glm::determinant(linear) < 0 ? -t.w : t.w);
}

const CellGrid* Triangle::cells() const {
    const LightCells& cells = scene_.light_cells;
    const bool lights = !instance_ && cells.grid_of[stored_] != NO_GRID;
    return lights ? &cells.grids[cells.grid_of[stored_]] : nullptr;
}

glm::dvec3 Triangle::stored_corner(int k) const { return glm::dvec3(scene_.vertices[vertex(k)]); }

glm::dmat3 Triangle::to_mesh() const {
    return instance_ ? glm::inverse(linear_part(*instance_)) : glm::dmat3(1);
}

glm::dvec3 Triangle::place() const { return instance_ ? place_of(*instance_) : glm::dvec3(0); }

glm::dvec3 Triangle::frame_rounding() const {
    if (!instance_) return glm::dvec3(0);
    glm::dvec3 farthest(0);
    for (int k = 0; k < 3; ++k) farthest = glm::max(farthest, glm::abs(corner(k) - place()));
    return sizes(linear_part(*instance_)) * (sizes(to_mesh()) * farthest);
}

}  // namespace manylight::reference

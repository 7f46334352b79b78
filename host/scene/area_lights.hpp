// SPDX-License-Identifier: MIT
// Area lights of emissive triangles.
#pragma once

#include <functional>
#include <vector>

#include "scene/scene.hpp"

namespace manylight {

/// An emissive triangle, world space.
struct Emitter {
    glm::vec3 vertices[3];
    glm::vec3 radiance;      // cd/m2
    bool both_sides;         // or only the side that the winding faces
    float offset;            // by which shadow rays end before it, m
    double power;            // of all sides that emit, lm
    std::uint32_t material;  // into Scene::materials
    std::uint32_t triangle;  // of the scene
    bool varies = false;     // radiance is the mean, and a part's is by radiance_of_part

    [[nodiscard]] glm::vec3 edge1() const { return vertices[1] - vertices[0]; }
    [[nodiscard]] glm::vec3 edge2() const { return vertices[2] - vertices[0]; }
};

struct AreaLights {
    std::vector<Light> lights;               // without their power
    std::vector<CellGrid> grids;             // [emitter] how it is cut
    std::vector<std::uint32_t> cell_lights;  // [CellGrid::first + cell] into lights, or NO_LIGHT
};

/// The mean radiance, cd/m2, of a part of an emitter over which it varies: the parallelogram or
/// triangle of u and v at `corner`, by weights of the emitter's vertices 1 and 2.
using RadianceOfPart = std::function<glm::vec3(const Emitter& emitter, glm::dvec2 corner,
                                               glm::dvec2 u, glm::dvec2 v, bool triangle)>;

/// The lights of emitters: two neighbours of one material that make a parallelogram are a
/// LIGHT_QUAD, others a LIGHT_TRIANGLE, and either is cut to cells of equal area, each of which is
/// a light. In the order of the emitters; two are where the first of them is. Cells of emitters
/// over which radiance varies are shorter by varied_cells, and those that are black are left out.
[[nodiscard]] AreaLights make_area_lights(const std::vector<Emitter>& emitters,
                                          const RadianceOfPart& radiance_of_part);

constexpr double varied_cells = 4;

}  // namespace manylight

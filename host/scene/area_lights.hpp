// SPDX-License-Identifier: MIT
// Area lights of emissive triangles.
#pragma once

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

    [[nodiscard]] glm::vec3 edge1() const { return vertices[1] - vertices[0]; }
    [[nodiscard]] glm::vec3 edge2() const { return vertices[2] - vertices[0]; }
};

struct AreaLights {
    std::vector<Light> lights;      // without their power
    std::vector<float> cell_areas;  // [emitter], m2, of each of the cells that it is cut to
};

/// The lights of emitters: two neighbours of one material that make a parallelogram are a
/// LIGHT_QUAD, others a LIGHT_TRIANGLE, and either is cut to cells of equal area, each of which is
/// a light. In the order of the emitters; two are where the first of them is.
[[nodiscard]] AreaLights make_area_lights(const std::vector<Emitter>& emitters);

}  // namespace manylight

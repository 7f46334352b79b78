// SPDX-License-Identifier: MIT
#pragma once

#include <functional>

#include "reference/samples.hpp"

namespace manylight::reference {

/// The numbers, in [0, 1)^2, that a pixel sample's reflected direction is drawn from.
[[nodiscard]] glm::dvec2 reflection_point(uint pixel, uint pixel_sample, uint seed);

/// Stage reflections for one pixel sample.
struct Reflection {
    glm::dvec3 value{0};      // cd/m2
    double slack = 0;         // by how much rounding may change it, where asked for
    bool borderline = false;  // rounding decides what the ray hits, where asked for, or how light
                              // samples were drawn
};

/// The light, a cell of an area light, that a point of an emissive triangle is on.
struct CellAt {
    uint light = NO_LIGHT;
    double margin = 0;  // how far it is from the nearest edge of a cell that is a light, in parts
                        // of the cell's sides
};

/// Where in a cell, or below 0 how far out of it, a point of its plane is, in parts of its sides.
[[nodiscard]] double inside(const Light& cell, const glm::dvec3& point);

/// By the lights themselves: the one of the triangle's cells that holds the point.
[[nodiscard]] CellAt cell_at(const Scene& scene, uint triangle, const glm::dvec3& point);

/// How many light samples are expected on a light; see OneLight::expected_count().
using CountOf = std::function<ExpectedCount(uint light)>;

/// What stage reflections adds to the estimate at a surface; `judge`: fill slack and borderline
/// (slow). Without `count_of` one light sample is taken to be on each cell of an area light.
[[nodiscard]] Reflection reflection(const Scene& scene, const Tracer& tracer, const Viewer& viewer,
                                    const Surface& surface, uint pixel, uint pixel_sample,
                                    uint seed, bool judge, const CountOf& count_of = {});

}  // namespace manylight::reference

// SPDX-License-Identifier: MIT
#include <cmath>

#include "scene/builtin/builtin.hpp"
#include "scene/builtin/random.hpp"

namespace manylight {

// Of intensities that are even in their logarithm, a few make most of the image, except where
// columns hide them.
void make_range(GltfWriter& out, const BuiltinOptions& options) {
    const float ratio = options.number("ratio");
    Random random(23);
    Mesh hall;
    hall.add_quad({-5, 0, 5}, {10, 0, 0}, {0, 0, -10});
    hall.add_walls(5, 4);
    Mesh columns;
    for (int i = 0; i < 16; ++i)
        columns.add_box(
            {-3.9f + 2.6f * static_cast<float>(i % 4), 0, -4.2f + 2.1f * static_cast<float>(i / 4)},
            {0.5f, 3.6f, 0.5f}, 0.3f * static_cast<float>(i));
    out.add_mesh("hall", hall, out.add_diffuse({0.6f, 0.6f, 0.6f}));
    out.add_mesh("columns", columns, out.add_diffuse({0.6f, 0.5f, 0.4f}));
    for (int i = 0; i < 1000; ++i) {
        const glm::vec3 at = random.in({-4.9f, 0.2f, -4.9f}, {4.9f, 3.4f, 4.9f});
        out.add_point(at, hue_color(random.in(0, 1), 0.7f) * std::pow(ratio, random.in(-1, 0)));
    }
    out.add_camera("front", {0.2f, 1.7f, 4.9f}, {0, 1.3f, 0}, 1.0f, 16.f / 9);
}

}  // namespace manylight

// SPDX-License-Identifier: MIT
#include <cmath>

#include "scene/builtin/builtin.hpp"
#include "scene/builtin/random.hpp"

namespace manylight {

// Leaves of one area together, from large ones to ones far below a pixel's size.
void make_thicket(GltfWriter& out, const BuiltinOptions& options) {
    const unsigned leaves = options.count("leaves");
    const float size = 6 / std::sqrt(static_cast<float>(leaves));  // m
    Random random(37);
    Mesh ground;
    ground.add_quad({-4, 0, 4}, {8, 0, 0}, {0, 0, -8});
    ground.add_quad({-4, 0, -3}, {8, 0, 0}, {0, 4, 0});
    Mesh mesh;
    for (unsigned i = 0; i < leaves; ++i) {
        const glm::vec3 at = random.in({-2, 0.05f, -1.5f}, {2, 1.8f, 1});
        const glm::vec3 u = size * random.in(glm::vec3(-1), glm::vec3(1));
        const glm::vec3 v = size * random.in(glm::vec3(-1), glm::vec3(1));
        mesh.add_triangle(at, at + u, at + v);
    }
    out.add_mesh("ground", ground, out.add_diffuse({0.55f, 0.5f, 0.45f}));
    out.add_mesh("leaves", mesh, out.add_diffuse({0.35f, 0.6f, 0.25f}));
    for (int i = 0; i < 120; ++i) {
        const glm::vec3 at = i % 3 == 0 ? random.in({-2, 0.2f, -1.5f}, {2, 1.6f, 1})
                                        : random.in({-3.5f, 1.5f, -2.8f}, {3.5f, 3, 3});
        out.add_point(at, hue_color(random.in(0.05f, 0.2f), 0.5f) * random.in(0.1f, 1));
    }
    out.add_camera("front", {0.3f, 1.6f, 5}, {0, 0.9f, 0}, 0.75f, 16.f / 9);
}

}  // namespace manylight

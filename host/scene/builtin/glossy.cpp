// SPDX-License-Identifier: MIT
#include "scene/builtin/builtin.hpp"
#include "scene/builtin/random.hpp"

namespace manylight {

void make_glossy(GltfWriter& out, const BuiltinOptions& options) {
    Random random(11);
    Mesh floor;
    floor.add_quad({-6, 0, 6}, {12, 0, 0}, {0, 0, -12});
    Mesh walls;
    walls.add_walls(6, 4);
    Mesh boxes;
    Mesh columns;
    for (int i = 0; i < 14; ++i) {
        Mesh& mesh = i % 2 ? boxes : columns;
        const float x = random.in(-4.5f, 4.5f);
        const float z = random.in(-4.5f, 2);
        const float width = random.in(0.3f, 0.8f);
        mesh.add_box({x, 0, z}, {width, random.in(0.4f, 1.6f), width}, random.in(0, 3));
    }
    for (int i = 0; i < 1000; ++i) {
        const glm::vec3 at = random.in({-5.5f, 1.9f, -5.5f}, {5.5f, 3.2f, 5.5f});
        out.add_point(at, hue_color(random.in(0, 1), 0.95f) * random.in(0.05f, 0.4f));
    }
    out.add_mesh("floor", floor,
                 out.add_material({0.5f, 0.5f, 0.52f}, 1, options.number("roughness")));
    out.add_mesh("walls", walls, out.add_diffuse({0.5f, 0.5f, 0.5f}));
    out.add_mesh("boxes", boxes, out.add_diffuse({0.6f, 0.5f, 0.4f}));
    out.add_mesh("columns", columns, out.add_material({0.6f, 0.6f, 0.65f}, 1, 0.3f));
    out.add_camera("front", {0, 1.5f, 5.6f}, {0, 0.9f, 0}, 1.05f, 16.f / 9);
}

}  // namespace manylight

// SPDX-License-Identifier: MIT
#include "scene/builtin/builtin.hpp"
#include "scene/builtin/random.hpp"

namespace manylight {

// Emitters of one length and power, from squares to threads; every fourth is a triangle.
void make_tubes(GltfWriter& out, const BuiltinOptions& options) {
    constexpr float length = 1;
    const float width = length / options.number("aspect");
    Random random(31);
    Mesh floor;
    floor.add_quad({-3, 0, 3}, {6, 0, 0}, {0, 0, -6});
    Mesh walls;
    walls.add_quad({-3, 0, -3}, {6, 0, 0}, {0, 3, 0});
    walls.add_quad({-3, 0, 3}, {0, 0, -6}, {0, 3, 0});
    Mesh boxes;
    for (int i = 0; i < 5; ++i)
        boxes.add_box(random.in({-2.2f, 0, -2.2f}, {2.2f, 0, 0.6f}),
                      random.in({0.3f, 0.3f, 0.3f}, {0.8f, 1, 0.8f}), random.in(0, 3));
    out.add_mesh("floor", floor, out.add_material({0.5f, 0.5f, 0.5f}, 0, 0.3f));
    out.add_mesh("walls", walls, out.add_diffuse({0.6f, 0.6f, 0.6f}));
    out.add_mesh("boxes", boxes, out.add_diffuse({0.6f, 0.5f, 0.4f}));
    for (int i = 0; i < 16; ++i) {
        const glm::vec3 at = random.in({-2.4f, 1.3f, -2.6f}, {2.4f, 2.7f, 1.5f});
        const glm::vec3 along = glm::normalize(random.in({-1, -0.4f, -1}, {1, 0.4f, 1}));
        const glm::vec3 across = glm::normalize(glm::cross(along, glm::vec3(0, 1, 0)));
        Mesh tube;  // faces down
        if (i % 4 == 0)
            tube.add_triangle(at, at + along * length, at + across * (2 * width));
        else
            tube.add_quad(at, along * length, across * width);
        const glm::vec3 color = hue_color(random.in(0, 1), 0.5f) * random.in(0.5f, 1.5f);
        out.add_mesh("tube", tube, out.add_emitter(color / (length * width)));
    }
    out.add_camera("front", {0.3f, 1.7f, 4.6f}, {0, 0.9f, 0}, 0.8f, 16.f / 9);
}

}  // namespace manylight

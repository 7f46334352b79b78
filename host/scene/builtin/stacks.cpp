// SPDX-License-Identifier: MIT
#include "scene/builtin/builtin.hpp"
#include "scene/builtin/random.hpp"

namespace manylight {

// Lights at one place that shine in different directions and colours: no tree can part them by
// where they are.
void make_stacks(GltfWriter& out, const BuiltinOptions& options) {
    constexpr unsigned lights = 4096;
    const unsigned stack = options.count("stack");
    Random random(29);
    Mesh room;
    room.add_quad({-3, 0, 3}, {6, 0, 0}, {0, 0, -6});
    room.add_walls(3, 3);
    Mesh boxes;
    for (int i = 0; i < 5; ++i)
        boxes.add_box(random.in({-2.2f, 0, -2.2f}, {2.2f, 0, 0.6f}),
                      random.in({0.3f, 0.4f, 0.3f}, {0.8f, 1.3f, 0.8f}), random.in(0, 3));
    out.add_mesh("room", room, out.add_diffuse({0.6f, 0.6f, 0.6f}));
    out.add_mesh("boxes", boxes, out.add_diffuse({0.6f, 0.45f, 0.4f}));
    glm::vec3 at(0);
    for (unsigned i = 0; i < lights; ++i) {
        if (i % stack == 0) at = random.in({-2, 1.8f, -2}, {2, 2.7f, 2});
        const glm::vec3 direction = random.in(glm::vec3(-1), {1, 0.2f, 1});
        const glm::vec3 color = hue_color(random.in(0, 1), 0.8f) * random.in(0.1f, 1);
        if (i % 4 == 0)
            out.add_point(at, color * 0.01f);
        else
            out.add_spot(at, direction, color, 0.05f, 0.2f);
    }
    out.add_camera("front", {0.2f, 1.6f, 4.2f}, {0, 1.1f, 0}, 0.85f, 16.f / 9);
}

}  // namespace manylight

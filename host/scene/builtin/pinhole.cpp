// SPDX-License-Identifier: MIT
#include "scene/builtin/builtin.hpp"
#include "scene/builtin/random.hpp"

namespace manylight {

void make_pinhole(GltfWriter& out, const BuiltinOptions& options) {
    const float hole = options.number("hole");  // side, m
    constexpr float hole_y = 1.2f;
    Random random(5);
    Mesh room;  // two rooms: the dim one at z > 0, the lamp's at z < 0
    room.add_quad({-2, 0, 4}, {4, 0, 0}, {0, 0, -6});
    room.add_quad({-2, 2.5f, -2}, {4, 0, 0}, {0, 0, 6});
    room.add_quad({-2, 0, 4}, {0, 0, -6}, {0, 2.5f, 0});
    room.add_quad({2, 0, -2}, {0, 0, 6}, {0, 2.5f, 0});
    room.add_quad({-2, 0, -2}, {4, 0, 0}, {0, 2.5f, 0});
    room.add_quad({2, 0, 4}, {-4, 0, 0}, {0, 2.5f, 0});
    Mesh wall;  // about the hole
    wall.add_quad({-2, 0, 0}, {2 - hole / 2, 0, 0}, {0, 2.5f, 0});
    wall.add_quad({hole / 2, 0, 0}, {2 - hole / 2, 0, 0}, {0, 2.5f, 0});
    wall.add_quad({-hole / 2, 0, 0}, {hole, 0, 0}, {0, hole_y - hole / 2, 0});
    wall.add_quad({-hole / 2, hole_y + hole / 2, 0}, {hole, 0, 0},
                  {0, 2.5f - hole_y - hole / 2, 0});
    Mesh boxes;
    boxes.add_box({-0.3f, 0, 1.8f}, {0.6f, 0.9f, 0.5f}, 0.4f);
    boxes.add_box({0.9f, 0, 1.2f}, {0.5f, 1.4f, 0.5f}, -0.2f);
    out.add_mesh("room", room, out.add_diffuse({0.7f, 0.7f, 0.7f}));
    out.add_mesh("wall", wall, out.add_diffuse({0.6f, 0.55f, 0.5f}));
    out.add_mesh("boxes", boxes, out.add_diffuse({0.5f, 0.5f, 0.6f}));
    // Its beam falls on the floor between the boxes.
    out.add_point({-0.18f, 1.92f, -0.72f}, glm::vec3(1, 0.95f, 0.85f) * options.number("lamp"));
    for (int i = 0; i < 31; ++i)
        out.add_point(random.in({-1.8f, 1.9f, 0.3f}, {1.8f, 2.4f, 3.6f}),
                      hue_color(random.in(0, 1), 0.3f) * random.in(0.05f, 0.3f));
    out.add_camera("inside", {1.3f, 1.4f, 3.7f}, {-0.4f, 0.9f, 0}, 1.0f, 16.f / 9);
}

}  // namespace manylight

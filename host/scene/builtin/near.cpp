// SPDX-License-Identifier: MIT
#include "scene/builtin/builtin.hpp"
#include "scene/builtin/random.hpp"

namespace manylight {

// The closer lights are to a surface, the smaller the part of it that each of them lights alone.
void make_near(GltfWriter& out, const BuiltinOptions& options) {
    constexpr float width = 4;
    const float distance = width * options.number("distance");
    Random random(19);
    Mesh room;
    room.add_quad({-width / 2, 0, 0}, {width, 0, 0}, {0, 2.25f, 0});
    room.add_quad({-width / 2, 0, width}, {width, 0, 0}, {0, 0, -width});
    Mesh shelves;
    for (int i = 0; i < 5; ++i)
        shelves.add_box(random.in({-1.6f, 0, 0.3f}, {1.6f, 1.6f, 0.5f}),
                        random.in({0.3f, 0.1f, 0.1f}, {0.8f, 0.4f, 0.3f}));
    out.add_mesh("room", room, out.add_diffuse({0.65f, 0.6f, 0.55f}));
    out.add_mesh("shelves", shelves, out.add_diffuse({0.45f, 0.5f, 0.6f}));
    for (int i = 0; i < 400; ++i) {
        const float x = random.in(-1.95f, 1.95f);
        const float y = random.in(0.05f, 2.2f);
        out.add_point({x, y, distance}, hue_color(random.in(0, 1), 0.5f) * random.in(0.01f, 0.1f));
    }
    out.add_camera("front", {0, 1.2f, 3.9f}, {0, 1.05f, 0}, 0.62f, 16.f / 9);
}

}  // namespace manylight

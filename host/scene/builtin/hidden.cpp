// SPDX-License-Identifier: MIT
#include <cmath>

#include "scene/builtin/builtin.hpp"
#include "scene/builtin/random.hpp"

namespace manylight {

// Lights below a ceiling, and all others as close above it: only rays can tell them apart.
void make_hidden(GltfWriter& out, const BuiltinOptions& options) {
    constexpr int lights = 10'000;
    const auto visible =
        static_cast<int>(std::lround(lights * static_cast<double>(options.number("visible"))));
    Random random(17);
    Mesh room;
    room.add_quad({-3, 0, 3}, {6, 0, 0}, {0, 0, -6});
    room.add_quad({-3, 2.6f, -3}, {6, 0, 0}, {0, 0, 6});
    room.add_walls(3, 2.6f);
    Mesh boxes;
    for (int i = 0; i < 6; ++i)
        boxes.add_box(random.in({-2.4f, 0, -2.4f}, {2.4f, 0, 0.8f}),
                      random.in({0.3f, 0.4f, 0.3f}, {0.9f, 1.6f, 0.9f}), random.in(0, 3));
    out.add_mesh("room", room, out.add_diffuse({0.65f, 0.65f, 0.6f}));
    out.add_mesh("boxes", boxes, out.add_diffuse({0.5f, 0.45f, 0.6f}));
    for (int i = 0; i < lights; ++i) {
        const float y = i < visible ? random.in(2.2f, 2.55f) : random.in(2.65f, 3);
        const float x = random.in(-2.9f, 2.9f);
        out.add_point({x, y, random.in(-2.9f, 2.9f)},
                      hue_color(random.in(0, 1), 0.3f) * random.in(0.01f, 0.03f));
    }
    out.add_camera("inside", {0.4f, 1.5f, 2.9f}, {0, 1, -1}, 1.1f, 16.f / 9);
}

}  // namespace manylight

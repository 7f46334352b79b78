// SPDX-License-Identifier: MIT
#include "scene/builtin/builtin.hpp"
#include "scene/builtin/random.hpp"

namespace manylight {

// Depth edges that normals do not show: boards and wall face the camera alike, but half of the
// lights are between them and so light the wall alone.
void make_boards(GltfWriter& out, const BuiltinOptions& options) {
    const unsigned count = options.count("boards");
    Random random(13);
    Mesh wall;
    wall.add_quad({-4, -2.5f, -2}, {8, 0, 0}, {0, 5, 0});
    Mesh boards;
    const float step = 6 / static_cast<float>(count);
    for (unsigned i = 0; i < count; ++i)
        boards.add_quad({-3 + (static_cast<float>(i) + 0.25f) * step, -1.3f, 0}, {step / 2, 0, 0},
                        {0, 2.6f, 0});
    out.add_mesh("wall", wall, out.add_diffuse({0.6f, 0.6f, 0.65f}));
    out.add_mesh("boards", boards, out.add_diffuse({0.7f, 0.55f, 0.4f}));
    for (int i = 0; i < 64; ++i) {
        const glm::vec3 at = i % 2 == 0 ? random.in({-3, -1.2f, 0.4f}, {3, 1.2f, 2})
                                        : random.in({-3, -1.2f, -1.6f}, {3, 1.2f, -0.4f});
        out.add_point(at, hue_color(random.in(0, 1), 0.4f) * random.in(0.2f, 1.8f));
    }
    out.add_camera("front", {0, 0, 5}, {0, 0, 0}, 0.6f, 16.f / 9);
}

}  // namespace manylight

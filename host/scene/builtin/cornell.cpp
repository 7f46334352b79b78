// SPDX-License-Identifier: MIT
#include "scene/builtin/builtin.hpp"

namespace manylight {

void make_cornell(GltfWriter& out, const BuiltinOptions&) {
    Mesh white;
    white.add_quad({-1, 0, 1}, {2, 0, 0}, {0, 0, -2});  // floor
    white.add_quad({-1, 2, -1}, {2, 0, 0}, {0, 0, 2});  // ceiling
    white.add_quad({-1, 0, -1}, {2, 0, 0}, {0, 2, 0});  // back wall
    white.add_box({-0.35f, 0, -0.3f}, {0.6f, 1.2f, 0.6f}, 0.3f);
    white.add_box({0.35f, 0, 0.35f}, {0.6f, 0.6f, 0.6f}, -0.3f);
    Mesh left;
    left.add_quad({-1, 0, 1}, {0, 0, -2}, {0, 2, 0});
    Mesh right;
    right.add_quad({1, 0, -1}, {0, 0, 2}, {0, 2, 0});
    Mesh light;
    light.add_quad({-0.25f, 1.99f, -0.25f}, {0.5f, 0, 0}, {0, 0, 0.5f});
    out.add_mesh("white", white, out.add_diffuse({0.73f, 0.73f, 0.73f}));
    out.add_mesh("left", left, out.add_diffuse({0.63f, 0.06f, 0.05f}));
    out.add_mesh("right", right, out.add_diffuse({0.14f, 0.45f, 0.09f}));
    out.add_mesh("light", light, out.add_emitter({18, 15, 10}));
    out.add_camera("front", {0, 1, 4.4f}, {0, 1, 0}, 0.56f, 1);
    out.set_emitter_points(64);
}

}  // namespace manylight

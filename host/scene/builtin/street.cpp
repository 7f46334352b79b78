// SPDX-License-Identifier: MIT
#include <cmath>

#include "scene/builtin/builtin.hpp"
#include "scene/builtin/random.hpp"

namespace manylight {

// A slope that faces the camera, with houses, and lamps over their roofs: each a square, bright and
// so far away that it covers a twentieth of a pixel of an image 256 pixels high.
void make_street(GltfWriter& out, const BuiltinOptions& /*options*/) {
    Random random(29);
    constexpr int side = 100;      // lamps and metres
    constexpr float lamp = 0.09f;  // m
    Mesh slope;
    slope.add_quad({-60, -12, 10}, {120, 0, 0}, {0, 72, -120});
    out.add_mesh("slope", slope, out.add_diffuse({0.4f, 0.4f, 0.38f}));
    Mesh houses;
    for (int i = 0; i < 400; ++i) {
        const float x = random.in(-50, 50), along = random.in(0, 100);
        houses.add_box({x, -6.5f + 0.6f * along, -along}, {2, random.in(2, 4), 2},
                       random.in(0, 1.5f));
    }
    out.add_mesh("houses", houses, out.add_diffuse({0.6f, 0.5f, 0.45f}));
    const int colors[] = {out.add_emitter({9000, 7000, 4000}), out.add_emitter({6000, 7000, 9000}),
                          out.add_emitter({9000, 4000, 1500})};
    Mesh lamps[3];
    for (int i = 0; i < side * side; ++i) {
        const float x = static_cast<float>(i % side) - 50 + random.in(0, 1);
        const float along = static_cast<float>(i / side) + random.in(0, 1);
        lamps[random.below(3)].add_quad({x, -2.5f + 0.6f * along, -along}, {lamp, 0, 0},
                                        {0, lamp, 0});
    }
    for (int k = 0; k < 3; ++k) out.add_mesh("lamps", lamps[k], colors[k]);
    out.add_camera("valley", {0, 30, 150}, {0, 26, -50}, 0.5f, 16.f / 9);
}

}  // namespace manylight

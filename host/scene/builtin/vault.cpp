// SPDX-License-Identifier: MIT
#include <cmath>
#include <glm/gtc/constants.hpp>

#include "scene/builtin/builtin.hpp"
#include "scene/builtin/random.hpp"

namespace manylight {

// A closed room with a few lamps, among far more and brighter ones outside, none of which lights
// it.
void make_vault(GltfWriter& out, const BuiltinOptions& options) {
    constexpr int outside = 3000;
    const float ratio = options.number("outside");
    Random random(23);
    Mesh room;
    room.add_quad({-3, 0, 3}, {6, 0, 0}, {0, 0, -6});
    room.add_quad({-3, 2.6f, -3}, {6, 0, 0}, {0, 0, 6});
    room.add_walls(3, 2.6f);
    room.add_quad({3, 0, 3}, {-6, 0, 0}, {0, 2.6f, 0});  // behind the camera
    Mesh boxes;
    for (int i = 0; i < 5; ++i)
        boxes.add_box(random.in({-2.4f, 0, -2.4f}, {2.4f, 0, 0.8f}),
                      random.in({0.3f, 0.4f, 0.3f}, {0.9f, 1.4f, 0.9f}), random.in(0, 3));
    out.add_mesh("room", room, out.add_diffuse({0.65f, 0.65f, 0.6f}));
    out.add_mesh("boxes", boxes, out.add_diffuse({0.6f, 0.45f, 0.4f}));
    for (const glm::vec3 at : {glm::vec3(-1.8f, 2.2f, -1), {1.5f, 2.3f, 0}, {0.2f, 1.9f, -2.4f}})
        out.add_point(at, glm::vec3(0.3f));
    for (int i = 0; i < outside; ++i) {
        const float height = 2 * random.in(0, 1) - 1;
        const float turn = 2 * glm::pi<float>() * random.in(0, 1);
        const float across = std::sqrt(1 - height * height);
        const glm::vec3 towards(across * std::cos(turn), height, across * std::sin(turn));
        out.add_point(glm::vec3(0, 1.3f, 0) + random.in(5, 20) * towards,
                      hue_color(random.in(0, 1), 0.3f) * (0.3f * ratio * random.in(0.3f, 1)));
    }
    out.add_camera("inside", {0.4f, 1.5f, 2.9f}, {0, 1, -1}, 1.1f, 16.f / 9);
}

}  // namespace manylight

// SPDX-License-Identifier: MIT
#include "scene/builtin/builtin.hpp"
#include "scene/builtin/random.hpp"

namespace manylight {
namespace {

constexpr int rooms_per_side = 20;
constexpr int lights_per_room = 25;
constexpr float pitch = 4;  // from room to room, m
constexpr float height = 2.8f;
constexpr float thickness = 0.1f;
constexpr float door_width = 1;
constexpr float door_height = 2.1f;

// A wall from `start` along x or z, one room long, with a door somewhere unless it is outer.
void add_wall(Mesh& mesh, glm::vec3 start, bool along_x, bool outer, Random& random) {
    const auto piece = [&](float from, float to, float bottom, float top) {
        const float middle = (from + to) / 2;
        const glm::vec3 size = along_x ? glm::vec3(to - from, top - bottom, thickness)
                                       : glm::vec3(thickness, top - bottom, to - from);
        const glm::vec3 at = along_x ? glm::vec3(middle, bottom, 0) : glm::vec3(0, bottom, middle);
        mesh.add_box(start + at, size);
    };
    if (outer) return piece(0, pitch, 0, height);
    const float door = random.in(0.6f, pitch - 0.6f - door_width);
    piece(0, door, 0, height);
    piece(door, door + door_width, door_height, height);
    piece(door + door_width, pitch, 0, height);
}

}  // namespace

void make_rooms(GltfWriter& out, const BuiltinOptions&) {
    constexpr float side = rooms_per_side * pitch;
    Random random(20);
    Mesh shell;
    shell.add_quad({0, 0, side}, {side, 0, 0}, {0, 0, -side});
    shell.add_quad({0, height, 0}, {side, 0, 0}, {0, 0, side});
    Mesh walls;
    Mesh furniture;
    for (int i = 0; i <= rooms_per_side; ++i)
        for (int j = 0; j < rooms_per_side; ++j) {
            const bool outer = i == 0 || i == rooms_per_side;
            const float a = static_cast<float>(i) * pitch;
            const float b = static_cast<float>(j) * pitch;
            add_wall(walls, {b, 0, a}, true, outer, random);
            add_wall(walls, {a, 0, b}, false, outer, random);
        }
    for (int i = 0; i < rooms_per_side; ++i)
        for (int j = 0; j < rooms_per_side; ++j) {
            const glm::vec3 corner(static_cast<float>(i) * pitch, 0, static_cast<float>(j) * pitch);
            for (int k = 0; k < 3; ++k)
                furniture.add_box(corner + random.in({0.7f, 0, 0.7f}, {3.3f, 0, 3.3f}),
                                  random.in({0.3f, 0.3f, 0.3f}, {0.9f, 1.2f, 0.9f}),
                                  random.in(0, 3));
            const glm::vec3 tone = hue_color(random.in(0, 1), 0.45f);
            const float brightness = random.in(0.3f, 1.2f);
            for (int k = 0; k < lights_per_room; ++k)
                out.add_point(corner + random.in({0.3f, 2.3f, 0.3f}, {3.7f, 2.7f, 3.7f}),
                              tone * (brightness * random.in(0.2f, 1.8f)));
        }
    out.add_mesh("shell", shell, out.add_diffuse({0.65f, 0.62f, 0.58f}));
    out.add_mesh("walls", walls, out.add_diffuse({0.6f, 0.6f, 0.58f}));
    out.add_mesh("furniture", furniture, out.add_diffuse({0.5f, 0.42f, 0.35f}));
    out.add_camera("inside", {36.5f, 1.6f, 39.6f}, {38.6f, 1.2f, 32}, 1.3f, 16.f / 9);
}

}  // namespace manylight

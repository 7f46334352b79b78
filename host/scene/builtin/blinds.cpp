// SPDX-License-Identifier: MIT
#include <cmath>

#include "scene/builtin/builtin.hpp"
#include "scene/builtin/random.hpp"

namespace manylight {
namespace {

constexpr int leaves = 12'000;
constexpr float wall = -2;     // z of the wall with the window
constexpr float left = -1.6f;  // the window
constexpr float right = 1.6f;
constexpr float sill = 0.8f;
constexpr float lintel = 2.2f;

void add_room(GltfWriter& out) {
    Mesh room;
    room.add_quad({-3, 0, 4}, {6, 0, 0}, {0, 0, -6});
    room.add_quad({-3, 2.8f, -2}, {6, 0, 0}, {0, 0, 6});
    room.add_quad({-3, 0, 4}, {0, 0, -6}, {0, 2.8f, 0});
    room.add_quad({3, 0, -2}, {0, 0, 6}, {0, 2.8f, 0});
    room.add_quad({-3, 0, wall}, {left + 3, 0, 0}, {0, 2.8f, 0});
    room.add_quad({right, 0, wall}, {3 - right, 0, 0}, {0, 2.8f, 0});
    room.add_quad({left, 0, wall}, {right - left, 0, 0}, {0, sill, 0});
    room.add_quad({left, lintel, wall}, {right - left, 0, 0}, {0, 2.8f - lintel, 0});
    out.add_mesh("room", room, out.add_diffuse({0.7f, 0.7f, 0.68f}));
    Mesh table;
    table.add_box({0.4f, 0.7f, 0.3f}, {1.4f, 0.06f, 0.8f}, 0.2f);
    for (const glm::vec2 leg : {glm::vec2(-0.5f, -0.1f), {0.9f, 0}, {-0.2f, 0.7f}, {1.1f, 0.6f}})
        table.add_box({leg.x, 0, leg.y}, {0.07f, 0.7f, 0.07f});
    table.add_box({0.3f, 0.76f, 0.3f}, {0.25f, 0.3f, 0.25f}, 0.5f);
    out.add_mesh("table", table, out.add_diffuse({0.5f, 0.4f, 0.3f}));
}

void add_slats(GltfWriter& out, int slats) {
    Mesh mesh;
    const float step = (lintel - sill) / static_cast<float>(slats);
    for (int i = 0; i < slats; ++i) {
        const float y = sill + (static_cast<float>(i) + 0.5f) * step;
        mesh.add_quad({left, y, wall + 0.03f}, {right - left, 0, 0},
                      {0, 0.45f * step, -0.9f * step});
    }
    out.add_mesh("slats", mesh, out.add_diffuse({0.8f, 0.8f, 0.75f}));
}

void add_foliage(GltfWriter& out, Random& random) {
    Mesh mesh;
    for (int i = 0; i < leaves; ++i) {
        const glm::vec3 at = random.in({-4, 0.3f, -6.5f}, {4, 4.5f, -3.5f});
        const glm::vec3 u = random.in(glm::vec3(-0.09f), glm::vec3(0.09f));
        const glm::vec3 v = random.in(glm::vec3(-0.09f), glm::vec3(0.09f));
        mesh.add_triangle(at, at + u, at + v);
    }
    out.add_mesh("foliage", mesh, out.add_diffuse({0.2f, 0.5f, 0.15f}));
}

}  // namespace

void make_blinds(GltfWriter& out, const BuiltinOptions& options) {
    Random random(3);
    add_room(out);
    add_slats(out, static_cast<int>(options.count("slats")));
    add_foliage(out, random);
    out.add_directional({0.35f, -0.75f, 0.8f}, glm::vec3(1, 0.9f, 0.75f) * 9.f);
    for (int i = 0; i < 63; ++i)  // street lamps
        out.add_point(random.in({-8, 1, -12}, {8, 5, -7}),
                      hue_color(0.12f, 0.4f) * random.in(1, 12));
    for (int i = 0; i < 64; ++i) {  // lamps that shine at the window from behind the leaves
        const glm::vec3 at = random.in({-5, 1, -11}, {5, 6, -6.8f});
        const glm::vec3 target = random.in({left, sill, wall}, {right, lintel, wall});
        out.add_spot(at, target - at, glm::vec3(1, 0.85f, 0.6f) * random.in(5, 40), 0.1f, 0.35f);
    }
    for (int i = 0; i < 64; ++i)  // a string of small lights along the ceiling
        out.add_point({-2.8f + 5.6f * static_cast<float>(i) / 63, 2.7f,
                       0.5f + 2.5f * std::sin(static_cast<float>(i) * 0.4f)},
                      hue_color(static_cast<float>(i) / 64, 0.6f) * 0.02f);
    out.add_camera("inside", {1.4f, 1.5f, 3.7f}, {-0.2f, 1, -1}, 0.9f, 16.f / 9);
}

}  // namespace manylight

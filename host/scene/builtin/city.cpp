// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cmath>

#include "scene/builtin/builtin.hpp"
#include "scene/builtin/random.hpp"

namespace manylight {
namespace {

constexpr int blocks = 8;       // of buildings, along each side
constexpr float pitch = 16;     // from block to block, m
constexpr float footprint = 9;  // of a building, m
constexpr unsigned colors = 12;

// One lamp: a triangle of that size, m, at `position`, that faces `normal`.
void add_lamp(Mesh& mesh, glm::vec3 position, glm::vec3 normal, float lamp) {
    const glm::vec3 u = std::abs(normal.y) > 0.5f
                            ? glm::vec3(1, 0, 0)
                            : glm::normalize(glm::cross(glm::vec3(0, 1, 0), normal));
    const glm::vec3 v = glm::cross(normal, u);
    mesh.add_triangle(position - lamp / 2 * (u + v), position + lamp / 2 * (u - v),
                      position + lamp / 2 * v);
}

}  // namespace

void make_city(GltfWriter& out, const BuiltinOptions& options) {
    const unsigned lights = options.count("lights");
    constexpr float side = blocks * pitch;
    Random random(7);
    Mesh ground;
    ground.add_quad({-side / 2, 0, side / 2}, {side, 0, 0}, {0, 0, -side});
    Mesh buildings;
    std::array<float, blocks * blocks> heights;
    for (int i = 0; i < blocks * blocks; ++i) {
        heights[i] = random.in(6, 30);
        const glm::vec3 centre((static_cast<float>(i % blocks) + 0.5f) * pitch - side / 2, 0,
                               (static_cast<float>(i / blocks) + 0.5f) * pitch - side / 2);
        buildings.add_box(centre, {footprint, heights[i], footprint});
    }
    // The same light over all, however many lamps give it; so many fit on the walls.
    const float size = 0.06f * std::min(std::sqrt(1e5f / static_cast<float>(lights)), 1.0f);
    std::array<Mesh, colors> lamps;
    for (unsigned i = 0; i < lights; ++i) {
        Mesh& mesh = lamps[random.below(colors)];
        if (i % 4 == 0) {  // over the streets, shining down
            const bool along_x = random.below(2) == 0;
            const float across = static_cast<float>(random.below(blocks + 1)) * pitch - side / 2 +
                                 random.in(-2.5f, 2.5f);
            const float along = random.in(-side / 2, side / 2);
            add_lamp(mesh, {along_x ? along : across, random.in(6.5f, 8), along_x ? across : along},
                     {0, -1, 0}, size);
            continue;
        }
        const int block = static_cast<int>(random.below(blocks * blocks));
        const glm::vec3 centre((static_cast<float>(block % blocks) + 0.5f) * pitch - side / 2, 0,
                               (static_cast<float>(block / blocks) + 0.5f) * pitch - side / 2);
        const unsigned face = random.below(4);
        const glm::vec3 normal = face == 0   ? glm::vec3(1, 0, 0)
                                 : face == 1 ? glm::vec3(-1, 0, 0)
                                 : face == 2 ? glm::vec3(0, 0, 1)
                                             : glm::vec3(0, 0, -1);
        const glm::vec3 tangent = glm::cross(glm::vec3(0, 1, 0), normal);
        add_lamp(mesh,
                 centre + normal * (footprint / 2 + 0.02f) +
                     tangent * random.in(-footprint / 2 + 0.2f, footprint / 2 - 0.2f) +
                     glm::vec3(0, random.in(1, heights[block] - 0.3f), 0),
                 normal, size);
    }
    const float brightness = 3.6e5f / (static_cast<float>(lights) * size * size);
    for (unsigned c = 0; c < colors; ++c) {
        if (lamps[c].indices.empty()) continue;
        const float t = static_cast<float>(c) / colors;
        const glm::vec3 color = c % 4 == 3 ? hue_color(t, 0.8f) : hue_color(0.11f, 0.5f * t);
        out.add_mesh(
            "lamps", lamps[c],
            out.add_emitter(color * (brightness * (0.2f + 1.6f * std::fmod(c * 0.618f, 1.f)))));
    }
    out.add_mesh("ground", ground, out.add_diffuse({0.45f, 0.45f, 0.45f}));
    out.add_mesh("buildings", buildings, out.add_diffuse({0.6f, 0.55f, 0.5f}));
    out.add_camera("street", {-16.5f, 3.5f, 30}, {-15, 4, 0}, 1.2f, 16.f / 9);
}

}  // namespace manylight

// SPDX-License-Identifier: MIT
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "scene/builtin/builtin.hpp"
#include "scene/builtin/random.hpp"

namespace manylight {
namespace {

constexpr float half = 30;  // of the ground's side, m
constexpr int trees = 1500;
constexpr int leaves = 10'000;

// 5 m high, about the y axis.
void make_tree(Random& random, Mesh& trunk, Mesh& crown) {
    trunk.add_box({0, 0, 0}, {0.22f, 2.6f, 0.22f});
    for (int i = 0; i < leaves; ++i) {
        glm::vec3 in(2);
        while (glm::dot(in, in) > 1) in = random.in(glm::vec3(-1), glm::vec3(1));
        const glm::vec3 at = glm::vec3(0, 3.2f, 0) + glm::vec3(1.3f, 1.8f, 1.3f) * in;
        const glm::vec3 u = 0.07f * random.in(glm::vec3(-1), glm::vec3(1));
        const glm::vec3 v = 0.07f * random.in(glm::vec3(-1), glm::vec3(1));
        crown.add_triangle(at, at + u, at + v);
    }
}

}  // namespace

// Lamps in a wood: 15 million triangles that are two meshes in many places.
void make_forest(GltfWriter& out, const BuiltinOptions&) {
    Random random(41);
    Mesh ground;
    ground.add_quad({-half, 0, half}, {2 * half, 0, 0}, {0, 0, -2 * half});
    out.add_mesh("ground", ground, out.add_diffuse({0.35f, 0.4f, 0.25f}));
    Mesh trunk;
    Mesh crown;
    make_tree(random, trunk, crown);
    const int parts[] = {out.add_shape("trunk", trunk, out.add_diffuse({0.4f, 0.3f, 0.2f})),
                         out.add_shape("crown", crown, out.add_diffuse({0.3f, 0.55f, 0.2f}))};
    for (int i = 0; i < trees; ++i) {
        glm::vec3 at = random.in({-half, 0, -half}, {half, 0, half});
        if (std::abs(at.x) < 2 && at.z > -12)
            at.x += at.x < 0 ? -3.f : 3.f;  // a glade to look along
        glm::mat4 place = glm::translate(glm::mat4(1), at);
        place = glm::rotate(place, random.in(0, 6.28f), {0, 1, 0});
        place = glm::scale(place, glm::vec3(random.in(0.7f, 1.3f)));
        for (const int part : parts) out.add_node("tree", part, place);
    }
    for (int i = 0; i < 600; ++i)
        out.add_point(random.in({-half, 0.4f, -half}, {half, 2.8f, half}),
                      hue_color(random.in(0.05f, 0.16f), 0.6f) * random.in(0.5f, 3));
    out.add_camera("glade", {0, 1.7f, 18}, {0, 1.9f, 0}, 0.75f, 16.f / 9);
}

}  // namespace manylight

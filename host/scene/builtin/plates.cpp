// SPDX-License-Identifier: MIT
#include "scene/builtin/builtin.hpp"

namespace manylight {

// After Veach's scene for multiple importance sampling ("Robust Monte Carlo Methods for Light
// Transport Simulation", 1997, figure 9.2): plates from smooth to rough, lamps from small to large.
void make_plates(GltfWriter& out, const BuiltinOptions&) {
    Mesh room;
    room.add_quad({-6, -1.2f, 4}, {12, 0, 0}, {0, 0, -8});
    room.add_quad({-6, -1.2f, -4}, {12, 0, 0}, {0, 7, 0});
    out.add_mesh("room", room, out.add_diffuse(glm::vec3(0.35f)));
    const glm::vec3 eye(0, 2.6f, 8);
    const glm::vec3 lamps(0, 2.9f, -2.2f);  // the middle of their row
    const float roughness[] = {0.05f, 0.1f, 0.16f, 0.3f};
    for (int i = 0; i < 4; ++i) {
        // Each plate is turned so that its middle mirrors the row of lamps to the camera.
        const glm::vec3 middle(0, 1.05f - 0.5f * static_cast<float>(i),
                               -1.2f + 0.85f * static_cast<float>(i));
        const glm::vec3 normal =
            glm::normalize(glm::normalize(eye - middle) + glm::normalize(lamps - middle));
        const glm::vec3 x(7, 0, 0);
        const glm::vec3 y = 0.85f * glm::normalize(glm::cross(normal, x));
        Mesh plate;
        plate.add_quad(middle - (x + y) / 2.f, x, y);
        out.add_mesh("plate " + std::to_string(i + 1), plate,
                     out.add_material({0.75f, 0.73f, 0.7f}, 1, roughness[i]));
    }
    const float side[] = {0.1f, 0.25f, 0.6f, 1.2f};
    const glm::vec3 color[] = {{1, 0.5f, 0.4f}, {1, 0.9f, 0.4f}, {0.5f, 1, 0.5f}, {0.5f, 0.6f, 1}};
    for (int i = 0; i < 4; ++i) {
        const float s = side[i];
        const float x = 1.7f * static_cast<float>(i) - 2.55f;
        Mesh lamp;  // upright, to the camera's side
        lamp.add_quad(lamps + glm::vec3(x - s / 2, -s / 2, 0), {s, 0, 0}, {0, s, 0});
        out.add_mesh("lamp " + std::to_string(i + 1), lamp,
                     out.add_emitter(color[i] * (2.f / (s * s))));
    }
    out.add_camera("front", eye, {0, 0.9f, 0}, 0.56f, 16.f / 9);
}

}  // namespace manylight

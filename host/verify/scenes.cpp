// SPDX-License-Identifier: MIT
#include "verify/scenes.hpp"

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "verify/scene_maker.hpp"

namespace manylight {
namespace {

Mesh quad(glm::vec3 corner, glm::vec3 u, glm::vec3 v) {
    Mesh mesh;
    mesh.add_quad(corner, u, v);
    return mesh;
}

Mesh box(glm::vec3 centre, glm::vec3 size, float angle) {
    Mesh mesh;
    mesh.add_box(centre, size, angle);
    return mesh;
}

Mesh floor_of(float half) { return quad({-half, 0, half}, {2 * half, 0, 0}, {0, 0, -2 * half}); }

VerifyScene all_lights() {
    SceneMaker maker;
    maker.add(floor_of(3), maker.add(glossy({0.5f, 0.5f, 0.55f}, 0.6f, 0.25f)));
    maker.add(make_ball({-0.6f, 0.6f, 0}, 0.6f), maker.add(glossy({0.9f, 0.6f, 0.3f}, 1, 0.02f)));
    maker.add(box({0.8f, 0, -0.4f}, {0.7f, 1, 0.7f}, 0.5f), maker.add(diffuse({0.3f, 0.7f, 0.4f})));
    maker.add(quad({-0.4f, 2.2f, -0.4f}, {0.5f, 0, 0}, {0, 0, 0.5f}),
              maker.add(emitter({6, 5, 4})));
    Mesh triangle;
    triangle.add_triangle({1.8f, 0.4f, -1}, {1.6f, 1.4f, 0.2f}, {1.9f, 0.5f, 0.4f});
    maker.add(triangle, maker.add(emitter({3, 5, 4}, true)));
    maker.add(quad({-1.9f, 0.2f, -0.6f}, {0.3f, 0.4f, 0.1f}, {0, 0.3f, 0.4f}),
              maker.add(emitter({2, 3, 4}, true)));
    for (int i = 0; i < 3; ++i) {
        const float x = -1.5f + static_cast<float>(i);
        const float range = i == 1 ? 2.5f : 0;
        maker.add(point_light({x, 1.6f, 1}, {0.5f, 0.4f, 0.6f}, range));
        maker.add(spot_light({x, 2, -1}, {0.3f, -1, 0.4f}, {2, 1.5f, 1}, i == 2 ? 0.7f : 0.2f, 0.7f,
                             range));
        maker.add(oriented_light({x, 2.1f, 0.3f}, {0.2f, -1, 0.3f}, {0.6f, 0.7f, 0.4f}));
    }
    maker.add(directional_light({0.4f, -1, -0.5f}, {0.6f, 0.6f, 0.5f}));
    maker.add(directional_light_from({0, 0.8f, 0}, {-0.5f, -1, 0.2f}, {0.4f, 0.5f, 0.6f}));
    return {"lights", "every kind of light, with and without ranges; metals, vertex normals",
            maker.finish(), look({0.3, 1.5, 3.6}, {0, 0.6, 0}, 0.9)};
}

VerifyScene many_points() {
    SceneMaker maker;
    Mesh room = floor_of(2);
    room.add_walls(2, 2);
    maker.add(room, maker.add(diffuse({0.7f, 0.65f, 0.6f})));
    Mesh boxes = box({-0.7f, 0, 0}, {0.8f, 1.1f, 0.5f}, 0.4f);
    boxes.add_box({0.6f, 0, 0.6f}, {0.6f, 0.6f, 0.6f}, -0.3f);
    boxes.add_box({0, 0, -1.2f}, {1.5f, 1.7f, 0.05f});
    maker.add(boxes, maker.add(diffuse({0.8f, 0.8f, 0.3f})));
    for (int i = 0; i < 600; ++i) {
        const float a = 2.399963f * static_cast<float>(i);
        const float r = 0.3f + 0.018f * static_cast<float>(i % 90) + (i % 5 == 0 ? 0.f : 1.5f);
        const float brightness = (i % 7 == 0 ? 10.f : 1.f) * (i % 5 == 0 ? 1.f : 30.f);
        maker.add(
            point_light({r * std::cos(a), 0.1f + 0.003f * static_cast<float>(i), r * std::sin(a)},
                        brightness * glm::vec3(0.02f, 0.03f, 0.025f)));
    }
    return {"points", "600 point lights, the bright ones behind walls; Lambert's materials",
            maker.finish(), look({0.2, 1.1, 1.95}, {0, 0.9, 0}, 1.2)};
}

void add_maps(SceneMaker& maker, std::uint32_t material, int shift, float scale, bool linear) {
    const TexelFormat formats[] = {TEXELS_SRGB, TEXELS_LINEAR, TEXELS_HALF};
    const TextureLevels levels[] = {LEVELS_FINEST, LEVELS_NEAREST, LEVELS_BLENDED};
    for (int kind = 0; kind < MAP_KIND_COUNT; ++kind)
        maker.add_map(material, static_cast<MapKind>(kind), formats[(kind + shift) % 3],
                      levels[(kind / 2 + shift) % 3], scale, linear);
}

// Colours of all vertices, and tangents of those that have normals, of either hand.
void color_vertices(Scene& scene) {
    for (std::size_t v = 0; v < scene.vertices.size(); ++v) {
        const glm::vec3 p = scene.vertices[v];
        scene.colors.emplace_back(1, 0.7f, 0.6f + 0.3f * std::sin(3 * p.x + p.y), 1);
        const glm::vec3 n = scene.vertex_normals[v];
        const glm::vec3 axis = std::abs(n.y) < 0.9f ? glm::vec3(0, 1, 0) : glm::vec3(1, 0, 0);
        scene.tangents.push_back(
            n == glm::vec3(0) ? float4(0)
                              : float4(glm::normalize(glm::cross(n, axis)), p.x < 0 ? 1 : -1));
    }
}

VerifyScene textured() {
    SceneMaker maker;
    Material polished = glossy({0.9f, 0.8f, 0.7f}, 0.8f, 0.6f);
    polished.specular = 0.9f;
    polished.reflectance = float4(0.05f, 4, 0.3f, 0);
    const std::uint32_t floor = maker.add(polished);
    polished.base_color = float4(0.5f, 0.8f, 0.9f, 0.3f);
    polished.roughness = 0.3f;
    polished.reflectance = float4(0.3f, 0.2f, 0.6f, 0);
    const std::uint32_t wall = maker.add(polished);
    const std::uint32_t ball = maker.add(glossy({0.7f, 0.7f, 0.6f}, 0.5f, 0.02f));
    const std::uint32_t lamp = maker.add(emitter({6, 5, 4}));
    const std::uint32_t screen = maker.add([] {
        Material m = emitter({1, 1, 1});
        m.base_color = float4(0.5f, 0.6f, 0.7f, 0);
        m.unlit = 1;
        return m;
    }());
    maker.add(floor_of(3), floor);
    maker.add(quad({-3, 0, -2}, {6, 0, 0}, {0, 3, 0.2f}), wall);
    maker.add(make_ball({0.7f, 0.6f, 0.2f}, 0.6f, 8), ball);
    maker.add(make_ball({-0.4f, 0.3f, 0.9f}, 0.3f, 6), ball);
    maker.add(quad({-1.5f, 2, -0.6f}, {1, 0, 0}, {0, 0, 1}), lamp);
    maker.add(quad({-1.4f, 0, 0.4f}, {0.6f, 0, -0.2f}, {0, 0.8f, 0}), screen);
    maker.spread_coordinates();
    color_vertices(maker.scene());
    // Seen larger than they are, and smaller.
    add_maps(maker, floor, 0, 6, true);
    add_maps(maker, wall, 1, 0.4f, true);
    maker.add_map(ball, MAP_NORMAL, TEXELS_LINEAR, LEVELS_BLENDED, 1, true);
    maker.add_map(ball, MAP_BASE_COLOR, TEXELS_SRGB, LEVELS_NEAREST, 3, false);
    maker.add_map(lamp, MAP_EMISSION, TEXELS_SRGB, LEVELS_FINEST, 1, true);
    maker.add_map(screen, MAP_BASE_COLOR, TEXELS_HALF, LEVELS_FINEST, 0.5f, false);
    for (int i = 0; i < 3; ++i)
        maker.add(point_light({static_cast<float>(i) - 1, 1.4f, 1.2f}, {0.5f, 0.6f, 0.4f}));
    maker.add(directional_light({-0.3f, -1, -0.4f}, {0.3f, 0.4f, 0.5f}));
    return {"textures", "textures of every format and wrap, tangents, vertex colours",
            maker.finish(), look({0.3, 1.2, 3}, {0, 0.6, 0}, 0.9)};
}

VerifyScene leaves() {
    SceneMaker maker;
    Material masked = diffuse({0.4f, 0.8f, 0.4f});
    masked.cutoff = 0.5f;
    const std::uint32_t leaf = maker.add(masked);
    masked.culled = 1;
    const std::uint32_t one_sided = maker.add(masked);
    Material blended = diffuse({0.7f, 0.5f, 0.3f});
    blended.alpha = 0.8f;
    blended.cutoff = -1;
    const std::uint32_t veil = maker.add(blended);
    Material culled = diffuse({0.3f, 0.5f, 0.8f});
    culled.culled = 1;
    maker.add(floor_of(3), maker.add(glossy({0.8f, 0.8f, 0.85f}, 1, 0.012f)));
    maker.add(quad({-1.7f, 0, 0.6f}, {1.2f, 0, 0.2f}, {0, 1, 0}), one_sided);
    maker.add(quad({1.4f, 0, -0.4f}, {-1.2f, 0, 0.1f}, {0, 1.2f, 0}), one_sided);
    maker.add(quad({0.2f, 0, 0.9f}, {1, 0, -0.2f}, {0, 0.7f, 0}), veil);
    maker.add(box({-0.5f, 0, -1}, {0.6f, 0.8f, 0.5f}, 0.3f), maker.add(culled));
    maker.add(quad({-0.6f, 2.2f, -0.6f}, {1.2f, 0, 0}, {0, 0, 1}), maker.add(emitter({5, 4, 3})));
    Mesh twig;
    twig.add_triangle({-0.4f, -0.5f, 0.1f}, {0.4f, -0.3f, 0}, {0.1f, 0.5f, -0.1f});
    twig.add_triangle({-0.3f, 0.4f, 0}, {-0.1f, -0.4f, 0.2f}, {0.3f, 0.3f, 0.1f});
    std::vector<glm::mat4> twigs;
    std::vector<glm::mat4> balls;
    for (int i = 0; i < 6; ++i) {
        const float a = 1.1f * static_cast<float>(i);
        const glm::mat4 place = glm::rotate(
            glm::translate(glm::mat4(1), {1.4f * std::cos(a), 0.7f, 1.1f * std::sin(a) - 0.3f}), a,
            {0.2f, 1, 0.1f});
        const float mirror = i % 2 ? -0.9f : 1.f;
        twigs.push_back(glm::scale(place, {mirror, 1.1f, 0.8f}));
        if (i % 3 == 0) balls.push_back(glm::scale(place, {1.f, mirror, 0.7f}));
    }
    maker.add_shared(twig, leaf, twigs);
    maker.add_shared(make_ball({0, 0, 0}, 0.3f, 5),
                     maker.add(glossy({0.8f, 0.6f, 0.5f}, 1, 0.015f)), balls);
    maker.spread_coordinates();
    for (const std::uint32_t m : {leaf, one_sided})
        maker.add_map(m, MAP_BASE_COLOR, TEXELS_SRGB, LEVELS_BLENDED, 1, true);
    for (int i = 0; i < 3; ++i)
        maker.add(point_light({static_cast<float>(i) - 1, 1.7f, 0.8f}, {0.5f, 0.6f, 0.4f}));
    maker.add(spot_light({1, 2, 1.5f}, {-0.5f, -1, -0.8f}, {3, 3, 2}, 0.3f, 0.8f));
    return {"leaves", "masks, what is there by chance, one-sided surfaces, instances, mirrored too",
            maker.finish(), look({0.2, 1.3, 3.2}, {0, 0.6, 0}, 0.9)};
}

VerifyScene polished() {
    SceneMaker maker;
    maker.add(floor_of(3), maker.add(diffuse({0.5f, 0.5f, 0.5f})));
    const float alphas[] = {0.002f, 0.008f, 0.02f};
    for (int i = 0; i < 3; ++i) {
        Material m = glossy({0.8f, 0.75f, 0.7f}, i == 1 ? 0.f : 1.f, alphas[i]);
        if (i == 1) m.reflectance = float4(0.2f, 0.1f, 0.4f, 0);
        const float x = 1.1f * static_cast<float>(i) - 1.6f;
        maker.add(quad({x, 0.1f, 0.8f}, {1, 0, 0}, {0, 0.3f, -1.2f}), maker.add(m));
    }
    maker.add(quad({-1.2f, 0.6f, -1}, {0.8f, 0, 0}, {0, 0.8f, 0.1f}),
              maker.add(emitter({6, 3, 2})));
    maker.add(quad({0.3f, 0.5f, -1.2f}, {1, 0.1f, 0}, {0, 1, 0}), maker.add(emitter({2, 3, 6})));
    Mesh triangle;
    triangle.add_triangle({-0.4f, 1.2f, 0}, {0.5f, 1.3f, 0.1f}, {0, 1.7f, -0.3f});
    maker.add(triangle, maker.add(emitter({3, 5, 4}, true)));
    return {"mirrors", "lamps in polished surfaces; area lights alone", maker.finish(),
            look({0, 1.3, 3}, {0, 0.5, 0}, 0.9)};
}

}  // namespace

std::vector<VerifyScene> verify_scenes() {
    return {all_lights(), many_points(), textured(), leaves(), polished()};
}

View without_perspective(View view) {
    view.orthographic = true;
    view.half_height *= 3;
    return view;
}

VerifyScene blend_scene(float alpha) {
    SceneMaker maker;
    maker.add(floor_of(2), maker.add(diffuse({0.5f, 0.5f, 0.5f})));
    Material shade = diffuse({0.7f, 0.7f, 0.7f});
    shade.alpha = alpha;
    shade.cutoff = -1;
    maker.add(quad({-2, 0.5f, 2}, {4, 0, 0}, {0, 0, -4}), maker.add(shade));
    maker.add(point_light({0.1f, 1.5f, 0.2f}, {1, 1, 1}));
    return {"veil", "a shade that is there by chance", maker.finish(),
            look({0, 2, 0}, {0, 0, 0}, 0.8)};
}

}  // namespace manylight

// SPDX-License-Identifier: MIT
#include "scene/alpha.hpp"

#include <algorithm>

namespace manylight {
namespace {

AlphaTriangle alpha_of(const Scene& scene, std::size_t triangle) {
    const std::uint32_t material = scene.triangle_materials[triangle];
    const std::uint32_t* corner = &scene.indices[3 * triangle];
    AlphaTriangle out{};
    for (int k = 0; k < 3; ++k)
        out.alphas[k] = scene.materials[material].alpha *
                        (scene.colors.empty() ? 1 : scene.colors[corner[k]].a);
    out.second.z = scene.materials[material].cutoff;
    out.culled = scene.materials[material].culled;
    out.texture = NO_TEXTURE;
    if (scene.maps.empty() || out.second.z == 0) return out;
    const TextureMap& map = scene.maps[MAP_KIND_COUNT * material + MAP_BASE_COLOR];
    out.texture = map.texture;
    if (map.texture == NO_TEXTURE) return out;
    glm::vec2 at[3];
    for (int k = 0; k < 3; ++k) {
        const glm::vec3 st(scene.coordinates[map.set][corner[k]], 1);
        at[k] = {glm::dot(glm::vec3(map.u), st), glm::dot(glm::vec3(map.v), st)};
    }
    out.first = float4(at[0], at[1] - at[0]);
    out.second.x = at[2].x - at[0].x;
    out.second.y = at[2].y - at[0].y;
    return out;
}

// Whether rays may pass: not where all is there without asking a texture.
bool may_pass(const AlphaTriangle& t) {
    if (t.culled != 0) return true;
    const float least = std::min({t.alphas.x, t.alphas.y, t.alphas.z});
    return t.texture != NO_TEXTURE || least < (t.second.z > 0 ? t.second.z : 1.f);
}

}  // namespace

void find_alpha(Scene& scene) {
    scene.alpha_triangles.clear();
    scene.alpha_of.clear();
    for (std::size_t t = 0; t < scene.triangle_count(); ++t) {
        const Material& material = scene.materials[scene.triangle_materials[t]];
        if (material.cutoff == 0 && material.culled == 0) continue;
        const AlphaTriangle own = alpha_of(scene, t);
        if (!may_pass(own)) continue;
        if (scene.alpha_of.empty()) scene.alpha_of.assign(scene.triangle_count(), NO_ALPHA);
        scene.alpha_of[t] = static_cast<std::uint32_t>(scene.alpha_triangles.size());
        scene.alpha_triangles.push_back(own);
    }
}

void mask_all_alpha(Scene& scene) {
    for (Material& material : scene.materials)
        if (material.cutoff < 0) material.cutoff = 0.5f;
    find_alpha(scene);
}

}  // namespace manylight

// SPDX-License-Identifier: MIT
#include "verify/scene_maker.hpp"

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "scene/alpha.hpp"
#include "scene/textures.hpp"

namespace manylight {
namespace {

// Colours in no order, of which every third has a hole; halves go beyond 1.
DecodedImage make_image(TexelFormat format, unsigned width, unsigned height) {
    DecodedImage image;
    image.width = width;
    image.height = height;
    for (unsigned i = 0; i < width * height; ++i)
        for (unsigned channel = 0; channel < 4; ++channel) {
            const unsigned mixed = (i * 2654435761u + channel * 40503u) >> 7;
            const unsigned byte = channel == 3 ? (i % 3 == 0 ? 40 : 255) : 60 + mixed % 196;
            if (format == TEXELS_HALF)
                image.floats.push_back(static_cast<float>(byte) / 200);
            else
                image.bytes.push_back(static_cast<std::uint8_t>(byte));
        }
    return image;
}

}  // namespace

Material diffuse(glm::vec3 color) {
    Material m{};
    m.base_color = float4(color, 0);
    m.reflectance = float4(glm::vec3(USUAL_REFLECTANCE), 0);
    m.roughness = 1;
    m.alpha = 1;
    return m;
}

Material glossy(glm::vec3 color, float metallic, float alpha) {
    Material m = diffuse(color);
    m.base_color.w = metallic;
    m.roughness = alpha;
    m.specular = 1;
    return m;
}

Material emitter(glm::vec3 radiance, bool both_sides) {
    Material m = diffuse(glm::vec3(0));
    m.emission = float4(radiance, both_sides ? 1 : 0);
    return m;
}

Light point_light(glm::vec3 position, glm::vec3 intensity, float range) {
    return {float4(position, LIGHT_POINT), float4(0, 0, 0, range), float4(0), float4(intensity, 0)};
}

Light spot_light(glm::vec3 position, glm::vec3 direction, glm::vec3 intensity, float inner,
                 float outer, float range) {
    return {float4(position, LIGHT_SPOT), float4(glm::normalize(direction), range),
            float4(spot_cone(inner, outer), 0, 0), float4(intensity, 0)};
}

Light directional_light(glm::vec3 direction, glm::vec3 illuminance) {
    return {float4(0, 0, 0, LIGHT_DIRECTIONAL), float4(glm::normalize(direction), 0), float4(0),
            float4(illuminance, 0)};
}

Light directional_light_from(glm::vec3 place, glm::vec3 direction, glm::vec3 illuminance) {
    Light light = directional_light(direction, illuminance);
    light.edge = float4(glm::dot(glm::vec3(light.axis), place), 1, 0, 0);
    return light;
}

Light oriented_light(glm::vec3 position, glm::vec3 normal, glm::vec3 intensity) {
    return {float4(position, LIGHT_ORIENTED), float4(glm::normalize(normal), 0),
            float4(0, 0, 0, 1e-5f), float4(intensity, 0)};
}

Mesh make_ball(glm::vec3 centre, float radius, int rings) {
    Mesh mesh;
    const int spokes = 2 * rings;
    for (int i = 0; i <= rings; ++i)
        for (int j = 0; j < spokes; ++j) {
            const float a = 3.14159265f * static_cast<float>(i) / static_cast<float>(rings);
            const float b = 6.28318531f * static_cast<float>(j) / static_cast<float>(spokes);
            const glm::vec3 n(std::sin(a) * std::cos(b), std::cos(a), std::sin(a) * std::sin(b));
            mesh.positions.push_back(centre + radius * n);
            mesh.normals.push_back(glm::normalize(n));
        }
    const auto at = [&](int i, int j) {
        return static_cast<std::uint32_t>(i * spokes + j % spokes);
    };
    for (int i = 0; i < rings; ++i)
        for (int j = 0; j < spokes; ++j)
            for (const std::uint32_t k : {at(i, j), at(i, j + 1), at(i + 1, j), at(i + 1, j),
                                          at(i, j + 1), at(i + 1, j + 1)})
                mesh.indices.push_back(k);
    return mesh;
}

View look(glm::dvec3 eye, glm::dvec3 target, double yfov) {
    View view;
    view.name = "front";
    const glm::dvec3 away = glm::normalize(eye - target);
    const glm::dvec3 up = std::abs(away.y) > 0.99 ? glm::dvec3(0, 0, -1) : glm::dvec3(0, 1, 0);
    view.to_world = glm::inverse(glm::lookAt(eye, target, up));
    view.half_height = std::tan(yfov / 2);
    return view;
}

std::uint32_t SceneMaker::add(const Material& material) {
    scene_.materials.push_back(material);
    return static_cast<std::uint32_t>(scene_.materials.size() - 1);
}

void SceneMaker::add(const Mesh& mesh, std::uint32_t material) {
    const auto first = static_cast<std::uint32_t>(scene_.vertices.size());
    scene_.vertices.insert(scene_.vertices.end(), mesh.positions.begin(), mesh.positions.end());
    if (!mesh.normals.empty() || !scene_.vertex_normals.empty()) {
        scene_.vertex_normals.resize(first, glm::vec3(0));
        scene_.vertex_normals.insert(scene_.vertex_normals.end(), mesh.normals.begin(),
                                     mesh.normals.end());
        scene_.vertex_normals.resize(scene_.vertices.size(), glm::vec3(0));
    }
    for (const std::uint32_t index : mesh.indices) scene_.indices.push_back(first + index);
    scene_.triangle_materials.resize(scene_.indices.size() / 3, material);
}

void SceneMaker::add_shared(const Mesh& mesh, std::uint32_t material,
                            const std::vector<glm::mat4>& places) {
    SharedMesh shared{};
    shared.first_triangle = static_cast<std::uint32_t>(scene_.triangle_count());
    shared.first_vertex = static_cast<std::uint32_t>(scene_.vertices.size());
    add(mesh, material);
    shared.triangle_count =
        static_cast<std::uint32_t>(scene_.triangle_count()) - shared.first_triangle;
    shared.vertex_count = static_cast<std::uint32_t>(scene_.vertices.size()) - shared.first_vertex;
    for (const glm::vec3& v : mesh.positions) shared.bounds.add(v);
    for (const glm::mat4& place : places) {
        Instance& in = scene_.instances.emplace_back(make_instance(glm::dmat4(place)));
        in.mesh = static_cast<std::uint32_t>(scene_.shared_meshes.size());
        in.stored = shared.first_triangle;
    }
    scene_.shared_meshes.push_back(shared);
}

void SceneMaker::spread_coordinates() {
    scene_.coordinates.resize(2);
    for (const glm::vec3& v : scene_.vertices) {
        scene_.coordinates[0].emplace_back(0.9f * v.x + 0.3f * v.y, 0.8f * v.z - 0.7f * v.y);
        scene_.coordinates[1].emplace_back(0.5f * v.z - 0.6f * v.x + 0.1f, 0.8f * v.y + 0.4f * v.x);
    }
}

void SceneMaker::add_map(std::uint32_t material, MapKind kind, TexelFormat format,
                         TextureLevels levels, float scale, bool linear) {
    scene_.maps.resize(MAP_KIND_COUNT * scene_.materials.size(),
                       {float4(0), float4(0), NO_TEXTURE, 0, 0, 0});
    scene_.maps[MAP_KIND_COUNT * material + kind] = {float4(scale, 0.2f, 0.3f, 0),
                                                     float4(-0.2f, scale, 0.1f, 0),
                                                     static_cast<uint>(scene_.textures.size()),
                                                     kind % 2u,
                                                     0.6f,
                                                     0};
    Texture texture = add_texels(scene_, make_image(format, 8, 4 + kind % 2),
                                 {.color = format == TEXELS_SRGB}, "verify");
    texture.wrap_u = kind % 3;
    texture.wrap_v = (kind + 1) % 3;
    texture.magnified_linear = texture.minified_linear = linear ? 1 : 0;
    texture.between = levels;
    scene_.textures.push_back(texture);
}

Scene SceneMaker::finish() {
    // Instances' triangles come behind all that are stored.
    std::size_t next = scene_.triangle_count();
    for (Instance& in : scene_.instances) {
        in.first = static_cast<std::uint32_t>(next);
        next += scene_.shared_meshes[in.mesh].triangle_count;
    }
    if (!scene_.maps.empty())
        scene_.maps.resize(MAP_KIND_COUNT * scene_.materials.size(),
                           {float4(0), float4(0), NO_TEXTURE, 0, 0, 0});
    find_alpha(scene_);
    add_emitters(scene_, 0);
    return std::move(scene_);
}

}  // namespace manylight

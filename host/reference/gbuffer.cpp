// SPDX-License-Identifier: MIT
#include "reference/gbuffer.hpp"

#include "reference/random.hpp"
#include "reference/textures.hpp"
#include "reference/triangle.hpp"

namespace manylight::reference {

glm::dvec2 sample_point(const Tiles& tiles, uint x, uint y, bool jitter, uint pixel_sample,
                        uint seed) {
    const glm::dvec2 within =
        jitter ? pixel_position(y * tiles.width + x, pixel_sample, seed) : glm::dvec2(0.5);
    return glm::dvec2(x, y) + within;
}

Ray primary_ray(const Camera& camera, const Tiles& tiles, const glm::dvec2& point) {
    const double sx = 2 * point.x / tiles.width - 1;
    const double sy = 1 - 2 * point.y / tiles.height;
    const glm::dvec3 offset = sx * glm::dvec3(camera.right) + sy * glm::dvec3(camera.up);
    const glm::dvec3 origin(camera.origin);
    const glm::dvec3 forward(camera.forward);
    const glm::dvec3 changes[] = {2.0 / tiles.width * glm::dvec3(camera.right),
                                  -2.0 / tiles.height * glm::dvec3(camera.up)};
    Ray ray{origin, forward};
    if (camera.forward.w != 0) {
        ray.origin += offset;
        for (int k = 0; k < 2; ++k) ray.origin_change[k] = changes[k];
        return ray;
    }
    const double length = glm::length(forward + offset);
    ray.direction = (forward + offset) / length;
    for (int k = 0; k < 2; ++k)
        ray.direction_change[k] =
            (changes[k] - glm::dot(changes[k], ray.direction) * ray.direction) / length;
    return ray;
}

namespace {

// How far off a triangle shadow rays start; see OFFSET_SCALE.
double shadow_offset(const Triangle& triangle, const Hit& hit) {
    const glm::dvec3 v0 = triangle.corner(0);
    const glm::dvec3 along1 = hit.u * (triangle.corner(1) - v0);
    const glm::dvec3 along2 = hit.v * (triangle.corner(2) - v0);
    const glm::dvec3 parts = glm::abs(v0 + along1 + along2) +
                             1e-6 * (glm::abs(v0) + glm::abs(along1) + glm::abs(along2)) +
                             triangle.frame_rounding();
    return OFFSET_SCALE * glm::dot(glm::abs(glm::normalize(triangle.face())), parts);
}

}  // namespace

Surface surface_at(const Scene& scene, const Ray& ray, const std::optional<Hit>& hit) {
    Surface surface{};
    surface.position.w = -1;
    if (!hit) return surface;
    const Triangle triangle(scene, hit->triangle);
    glm::dvec3 smooth(0);
    const double weights[3] = {1 - hit->u - hit->v, hit->u, hit->v};
    for (int k = 0; k < 3; ++k) smooth += weights[k] * triangle.normal(k);
    glm::dvec3 geometric = glm::normalize(triangle.face());
    const bool front = glm::dot(geometric, ray.direction) < 0;
    if (!front) geometric = -geometric;
    glm::dvec3 normal = smooth == glm::dvec3(0) ? geometric : glm::normalize(smooth);
    if (glm::dot(normal, geometric) < 0) normal = -normal;
    normal = normal_at(scene, ray, *hit, normal);
    const glm::dvec3 v0 = triangle.corner(0);
    const glm::dvec3 position =
        v0 + hit->u * (triangle.corner(1) - v0) + hit->v * (triangle.corner(2) - v0);
    surface.position = float4(glm::vec3(position), static_cast<float>(hit->t));
    surface.normal = float4(glm::vec3(normal), 0);
    surface.geometric =
        float4(glm::vec3(geometric), static_cast<float>(shadow_offset(triangle, *hit)));
    surface.triangle = hit->triangle;
    surface.material = triangle.material();
    surface.shading = surface.material;
    surface.front = front;
    return surface;
}

void own_material(Scene& scene, const Ray& ray, const std::optional<Hit>& hit, Surface& surface) {
    if (!hit) return;
    surface.shading = static_cast<uint>(scene.materials.size());
    scene.materials.push_back(material_at(scene, ray, *hit));
}

Surface gbuffer(const Scene& scene, const Tracer& tracer, const Camera& camera, const Tiles& tiles,
                uint x, uint y, bool jitter, uint pixel_sample, uint seed) {
    const Ray ray =
        primary_ray(camera, tiles, sample_point(tiles, x, y, jitter, pixel_sample, seed));
    return surface_at(scene, ray, tracer.closest_hit(ray));
}

}  // namespace manylight::reference

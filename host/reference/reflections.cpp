// SPDX-License-Identifier: MIT
#include "reference/reflections.hpp"

#include <algorithm>

#include "reference/material/ggx.hpp"
#include "reference/random.hpp"
#include "reference/textures.hpp"
#include "reference/triangle.hpp"

namespace manylight::reference {
namespace {

constexpr double epsilon = std::numeric_limits<float>::epsilon();

// What arrives along a ray of unit direction from the area light that it hits.
glm::dvec3 reflected(const Scene& scene, const Viewer& viewer, const Surface& surface,
                     const Ray& ray, const std::optional<Hit>& hit) {
    const glm::dvec3 normal = glm::normalize(glm::dvec3(surface.normal));
    const double cosine = glm::dot(normal, ray.direction);
    if (cosine <= 0 || glm::dot(glm::dvec3(surface.horizon), ray.direction) <= 0 || !hit)
        return glm::dvec3(0);
    const Triangle triangle(scene, hit->triangle);
    const double area = triangle.cell_area();
    if (area == 0) return glm::dvec3(0);
    const double emitted = -glm::dot(glm::normalize(triangle.face()), ray.direction);
    const float4 emission = material_at(scene, {ray.origin, ray.direction}, *hit).emission;
    if (emitted < 0 && emission.w == 0) return glm::dvec3(0);
    const double solid_angle = area * std::abs(emitted) / (hit->t * hit->t);
    const Material& material = scene.materials[surface.shading];
    const Brdf f =
        split_brdf(material, normal, ray.direction, viewer.direction(glm::dvec3(surface.position)));
    return f.specular * cosine * (1 - light_share(f.density, solid_angle)) / f.density *
           glm::dvec3(glm::vec3(emission)) * viewer.throughput();
}

}  // namespace

glm::dvec2 reflection_point(uint pixel, uint pixel_sample, uint seed) {
    const auto scramble = random_bits(pixel, 0, 0xfffffffcu, seed);
    return sobol_point(owen_scrambled(pixel_sample, scramble[2]), scramble[0], scramble[1]);
}

Reflection reflection(const Scene& scene, const Tracer& tracer, const Viewer& viewer,
                      const Surface& surface, uint pixel, uint pixel_sample, uint seed,
                      bool judge) {
    Reflection out;
    if (surface.position.w < 0) return out;
    const Material& material = scene.materials[surface.shading];
    const glm::dvec3 position(surface.position);
    if (!reflects(surface, material, viewer)) return out;
    Ray ray;
    ray.origin = position + glm::dvec3(surface.horizon) * double{surface.horizon.w};
    ray.direction =
        sample_lobe(double{material.roughness}, glm::normalize(glm::dvec3(surface.normal)),
                    viewer.direction(position), reflection_point(pixel, pixel_sample, seed));
    const std::optional<Hit> hit = tracer.closest_hit(ray);
    out.value = reflected(scene, viewer, surface, ray, hit);
    if (!judge) return out;
    // What the value comes from: cells of one material and area emit alike.
    const auto source = [&](const std::optional<Hit>& h) {
        if (!h) return std::pair(~0u, 0.0);
        const Triangle triangle(scene, h->triangle);
        return std::pair(triangle.material(), triangle.cell_area());
    };
    // Of the direction: of a unit vector's parts.
    const EndShifts shifts{origin_rounding(surface, ray.origin), glm::dvec3(16 * epsilon)};
    for (Ray moved : Tracer::neighbours(ray, shifts)) {
        moved.direction = glm::normalize(moved.direction);
        const std::optional<Hit> other = tracer.closest_hit(moved);
        const glm::dvec3 value = reflected(scene, viewer, surface, moved, other);
        const bool dark = value == glm::dvec3(0);
        if (dark != (out.value == glm::dvec3(0)) || (!dark && source(other) != source(hit)))
            out.borderline = true;
        else
            out.slack = std::max(out.slack, glm::length(value - out.value));
    }
    return out;
}

}  // namespace manylight::reference

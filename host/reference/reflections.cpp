// SPDX-License-Identifier: MIT
#include "reference/reflections.hpp"

#include <algorithm>
#include <tuple>

#include "reference/material/ggx.hpp"
#include "reference/random.hpp"
#include "reference/textures.hpp"
#include "reference/triangle.hpp"

namespace manylight::reference {
namespace {

constexpr double epsilon = std::numeric_limits<float>::epsilon();

glm::dvec3 point_of(const Ray& ray, const Hit& hit) { return ray.origin + hit.t * ray.direction; }

// How many light samples are expected on the cell that a ray has met.
ExpectedCount counts_at(const Scene& scene, const Ray& ray, const Hit& hit,
                        const CountOf& count_of) {
    if (!count_of) return {{{1, 1}}};
    const CellAt cell = cell_at(scene, hit.triangle, point_of(ray, hit));
    if (cell.light == NO_LIGHT) return {{{1, 0}}};
    return count_of(cell.light);
}

// What arrives along a ray of unit direction from the area light that it hits.
Reflection reflected(const Scene& scene, const Viewer& viewer, const Surface& surface,
                     const Ray& ray, const std::optional<Hit>& hit, const CountOf& count_of) {
    const glm::dvec3 normal = glm::normalize(glm::dvec3(surface.normal));
    const double cosine = glm::dot(normal, ray.direction);
    if (cosine <= 0 || glm::dot(glm::dvec3(surface.horizon), ray.direction) <= 0 || !hit) return {};
    const Triangle triangle(scene, hit->triangle);
    const CellGrid* grid = triangle.cells();
    if (grid == nullptr) return {};
    const double emitted = -glm::dot(glm::normalize(triangle.face()), ray.direction);
    const float4 emission = material_at(scene, {ray.origin, ray.direction}, *hit).emission;
    if (emitted < 0 && emission.w == 0) return {};
    const double solid_angle = grid->area * std::abs(emitted) / (hit->t * hit->t);
    const Material& material = scene.materials[surface.shading];
    const Brdf f =
        split_brdf(material, normal, ray.direction, viewer.direction(glm::dvec3(surface.position)));
    double share = 0;
    const ExpectedCount expected = counts_at(scene, ray, *hit, count_of);
    for (const auto& [part, count] : expected.rounds)
        share += part * (1 - light_share(f.density, solid_angle, count));
    Reflection out{.borderline = expected.doubtful};
    out.value = f.specular * cosine * share / f.density * glm::dvec3(glm::vec3(emission)) *
                viewer.throughput();
    return out;
}

}  // namespace

double inside(const Light& cell, const glm::dvec3& point) {
    const glm::dvec3 u(cell.axis);
    const glm::dvec3 v(cell.edge);
    const glm::dvec3 n = glm::cross(u, v);
    const glm::dvec3 d = point - glm::dvec3(cell.position);
    const double s = glm::dot(glm::cross(d, v), n) / glm::dot(n, n);
    const double t = glm::dot(glm::cross(u, d), n) / glm::dot(n, n);
    if (light_centroid_parts(static_cast<uint>(cell.position.w)) == 2)  // a parallelogram
        return std::min({s, 1 - s, t, 1 - t});
    return std::min({s, t, 1 - s - t});
}

CellAt cell_at(const Scene& scene, uint triangle, const glm::dvec3& point) {
    const CellGrid& grid = *Triangle(scene, triangle).cells();
    CellAt out{NO_LIGHT, -std::numeric_limits<double>::infinity()};
    for (uint i = 0; i < grid.columns * grid.rows; ++i) {
        const uint light = scene.light_cells.lights[grid.first + i];
        if (light == NO_LIGHT) continue;
        const double margin = inside(scene.lights[light], point);
        if (margin > out.margin) out = {light, margin};
    }
    if (out.margin < 0) return {NO_LIGHT, -out.margin};
    return out;
}

glm::dvec2 reflection_point(uint pixel, uint pixel_sample, uint seed) {
    const auto scramble = random_bits(pixel, 0, 0xfffffffcu, seed);
    return sobol_point(owen_scrambled(pixel_sample, scramble[2]), scramble[0], scramble[1]);
}

Reflection reflection(const Scene& scene, const Tracer& tracer, const Viewer& viewer,
                      const Surface& surface, uint pixel, uint pixel_sample, uint seed, bool judge,
                      const CountOf& count_of) {
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
    out = reflected(scene, viewer, surface, ray, hit, count_of);
    if (!judge) return out;
    // What the value comes from: cells of one material and area emit alike, but light samples are
    // not on them alike.
    const auto source = [&](const Ray& r, const std::optional<Hit>& h) {
        if (!h) return std::tuple(~0u, 0.f, NO_LIGHT);
        const Triangle triangle(scene, h->triangle);
        const CellGrid* grid = triangle.cells();
        if (grid == nullptr) return std::tuple(triangle.material(), 0.f, NO_LIGHT);
        const uint light = count_of ? cell_at(scene, h->triangle, point_of(r, *h)).light : NO_LIGHT;
        return std::tuple(triangle.material(), grid->area, light);
    };
    // Of the direction: of a unit vector's parts.
    const EndShifts shifts{origin_rounding(surface, ray.origin), glm::dvec3(16 * epsilon)};
    for (Ray moved : Tracer::neighbours(ray, shifts)) {
        moved.direction = glm::normalize(moved.direction);
        const std::optional<Hit> other = tracer.closest_hit(moved);
        const glm::dvec3 value = reflected(scene, viewer, surface, moved, other, count_of).value;
        const bool dark = value == glm::dvec3(0);
        if (dark != (out.value == glm::dvec3(0)) ||
            (!dark && source(moved, other) != source(ray, hit)))
            out.borderline = true;
        else
            out.slack = std::max(out.slack, glm::length(value - out.value));
    }
    return out;
}

}  // namespace manylight::reference

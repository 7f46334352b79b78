// SPDX-License-Identifier: MIT
// Stage gbuffer.
#include <algorithm>
#include <array>

#include "reference/gbuffer.hpp"
#include "reference/textures.hpp"
#include "reference/tiles.hpp"
#include "reference/triangle.hpp"
#include "verify/stages.hpp"
#include "verify/tolerances.hpp"

namespace manylight {
namespace {

using Values = std::array<double, 12>;

Values values_of(const Material& m) {
    return {m.base_color.x, m.base_color.y,  m.base_color.z,  m.base_color.w,
            m.emission.x,   m.emission.y,    m.emission.z,    m.roughness,
            m.specular,     m.reflectance.x, m.reflectance.y, m.reflectance.z};
}

// A triangle's height, and by how much rounding moves where a ray of unit direction hits it, m.
struct HitRounding {
    double height, position;
};

HitRounding rounding_of(const Scene& scene, uint triangle, const reference::Ray& ray,
                        double reach) {
    glm::dvec3 v[3];
    for (int k = 0; k < 3; ++k) v[k] = reference::Triangle(scene, triangle).corner(k);
    const glm::dvec3 cross = glm::cross(v[1] - v[0], v[2] - v[0]);
    const double longest =
        std::max({glm::length(v[1] - v[0]), glm::length(v[2] - v[1]), glm::length(v[0] - v[2])});
    const double height = glm::length(cross) / longest;
    const double cosine = std::abs(glm::dot(glm::normalize(cross), ray.direction));
    return {height, 8 * epsilon * reach * (longest / height) / std::max(cosine, 1e-6)};
}

// To all sides.
std::array<glm::dvec2, 4> steps_of(double length) {
    return {glm::dvec2(length, 0), glm::dvec2(-length, 0), glm::dvec2(0, length),
            glm::dvec2(0, -length)};
}

// The offset is the bound that it should be, as far as rounding of the normal, of the edges and, by
// `shift`, of the point's weights of vertices lets it, and takes shadow rays off the triangle.
void check_offset(Verifier& verifier, Check& check, const Surface& found, const reference::Ray& ray,
                  const reference::Hit& hit, double shift, const std::string& where) {
    const auto horizon = [&](const glm::dvec2& step) {
        const reference::Hit moved{hit.triangle, hit.t, hit.u + step.x, hit.v + step.y};
        return reference::surface_at(verifier.scene(), ray, moved).horizon;
    };
    const float4 at = horizon({0, 0});
    const double expected = at.w;
    const reference::Triangle triangle(verifier.scene(), hit.triangle);
    const glm::dvec3 normal = glm::normalize(triangle.face()) * (found.front ? 1.0 : -1.0);
    const bool lifted = glm::length(glm::dvec3(at) - normal) > 1e-6;
    double slack = 16 * epsilon * expected;
    if (lifted)
        for (const int k : {1, 2})
            slack += 16 * epsilon * glm::length(triangle.corner(k) - triangle.corner(0));
    for (const glm::dvec2& step : steps_of(shift)) slack += std::abs(horizon(step).w - expected);
    for (int axis = 0; axis < 3; ++axis)
        slack += OFFSET_SCALE * 3 * verifier.reach() *
                 std::abs(std::abs(found.horizon[axis]) - std::abs(at[axis]));
    check.compare(std::abs(found.horizon.w - expected), slack,
                  fmt::format("{}: offset {} is not {}", where, found.horizon.w, expected));
    const glm::dvec3 start =
        glm::dvec3(found.position) + glm::dvec3(found.horizon) * double{found.horizon.w};
    const double above = glm::dot(start - triangle.corner(0), normal);
    check.compare(above >= 0 ? 0 : 2, 1,
                  fmt::format("{}: shadow rays start {} m below the surface", where, -above));
}

// `shift`: what rounding may do to the point's weights of vertices.
void check_material(Verifier& verifier, Check& check, const Surface& found,
                    const reference::Ray& ray, const reference::Hit& hit, double shift,
                    const std::string& where) {
    if (!verifier.scene().varies_materials())
        return check.compare_exact(found.shading == found.material, where + ": shading");
    const auto values = [&](const glm::dvec2& step, double pixel) {
        reference::Ray moved = ray;
        for (int k = 0; k < 2; ++k) {
            moved.origin_change[k] *= pixel;
            moved.direction_change[k] *= pixel;
        }
        return values_of(reference::material_at(
            verifier.scene(), moved, {hit.triangle, hit.t, hit.u + step.x, hit.v + step.y}));
    };
    const Values expected = values({0, 0}, 1);
    Values slack{};
    const auto add_slack = [&](const Values& moved) {
        for (std::size_t i = 0; i < slack.size(); ++i) slack[i] += std::abs(moved[i] - expected[i]);
    };
    for (const glm::dvec2& step : steps_of(shift)) add_slack(values(step, 1));
    for (const double pixel : {1 - 1e-5, 1 + 1e-5}) add_slack(values({0, 0}, pixel));
    const Values own = values_of(verifier.scene().materials[found.shading]);
    for (std::size_t i = 0; i < slack.size(); ++i)
        check.compare(
            std::abs(own[i] - expected[i]),
            shading_roundings * epsilon * std::abs(expected[i]) + slack[i],
            fmt::format("{}: material's value {}: {} is not {}", where, i, own[i], expected[i]),
            own[i] == 0 && expected[i] == 0);
}

void check_surface(Verifier& verifier, Check& check, const Surface& found, uint x, uint y,
                   bool jitter) {
    const reference::Ray ray = reference::primary_ray(
        verifier.camera(), verifier.tiles(),
        reference::sample_point(verifier.tiles(), x, y, jitter, 3, verifier.options().seed));
    auto hit = verifier.tracer().closest_hit(ray);
    const std::string where = fmt::format("pixel ({}, {})", x, y);
    const bool found_hit = found.position.w >= 0;
    // Of triangles that meet where the ray does, any is right: it is judged by its own surface.
    if (found_hit && hit && found.triangle != hit->triangle) {
        const auto own = verifier.tracer().hit_near(found.triangle, ray);
        const double rounding =
            rounding_of(verifier.scene(), found.triangle, ray, verifier.reach()).position +
            rounding_of(verifier.scene(), hit->triangle, ray, verifier.reach()).position;
        if (own && std::abs(own->t - hit->t) <= rounding) hit = own;
    }
    const Surface expected = reference::surface_at(verifier.scene(), ray, hit);
    if (found_hit != hit.has_value() || (found_hit && found.triangle != hit->triangle)) {
        // Another triangle is right if a ray that rounding cannot tell apart hits it, and nothing
        // well before it: where two triangles meet, rounding tells which is in front.
        const double shift = 16 * epsilon * verifier.reach();
        for (const reference::Ray& moved :
             reference::Tracer::neighbours(ray, {glm::dvec3(shift), glm::dvec3(2 * shift)})) {
            const auto closest = verifier.tracer().closest_hit(moved);
            if (!found_hit && !closest) return check.skip_borderline();
            if (!found_hit) continue;
            const auto own = verifier.tracer().hit_of(found.triangle, moved);
            if (own && own->t <= closest->t + 64 * shift) return check.skip_borderline();
        }
        check.compare(
            2, 1,
            fmt::format("{}: triangle {} is hit at {}, not {} at {}", where, found.triangle,
                        found.position.w, hit ? hit->triangle : ~0u, hit ? hit->t : -1));
        return;
    }
    if (!found_hit) return check.compare(0, 1, where);
    const auto [height, shift] =
        rounding_of(verifier.scene(), found.triangle, ray, verifier.reach());
    check.compare(glm::length(glm::dvec3(found.position) - glm::dvec3(expected.position)), shift,
                  fmt::format("{}: position {} is not {}", where, show(found.position),
                              show(expected.position)));
    check.compare(
        std::abs(double{found.position.w} - expected.position.w), shift,
        fmt::format("{}: distance {} is not {}", where, found.position.w, expected.position.w));
    const double normal_shift = 16 * epsilon * (1 + verifier.reach() / height);
    // Interpolated normals, by which the horizon may be, turn with the point.
    const double smooth_shift = normal_shift + 4 * shift / height;
    const auto turned = [](const Surface& a, const Surface& b) {
        return glm::length(glm::dvec3(a.horizon) - glm::dvec3(b.horizon));
    };
    // Where the horizon is lifted as far as it has to be at the least, rounding decides.
    if (turned(found, expected) > smooth_shift)
        for (const glm::dvec2& step : steps_of(shift / height)) {
            const reference::Hit moved{hit->triangle, hit->t, hit->u + step.x, hit->v + step.y};
            if (turned(reference::surface_at(verifier.scene(), ray, moved), expected) >
                16 * smooth_shift)
                return check.skip_borderline();
        }
    check.compare(turned(found, expected), smooth_shift,
                  fmt::format("{}: horizon's normal {} is not {}", where, show(found.horizon),
                              show(expected.horizon)));
    double mapped_shift = 0;  // by what a normal map says nearby
    if (verifier.scene().varies_materials())
        for (const glm::dvec2& step : steps_of(shift / height)) {
            const reference::Hit moved{hit->triangle, hit->t, hit->u + step.x, hit->v + step.y};
            const Surface there = reference::surface_at(verifier.scene(), ray, moved);
            mapped_shift += glm::length(glm::dvec3(there.normal) - glm::dvec3(expected.normal));
        }
    check.compare(
        glm::length(glm::dvec3(found.normal) - glm::dvec3(expected.normal)),
        smooth_shift + mapped_shift,
        fmt::format("{}: normal {} is not {}", where, show(found.normal), show(expected.normal)));
    check_offset(verifier, check, found, ray, *hit, shift / height, where);
    check.compare_exact(found.material == expected.material && found.front == expected.front,
                        where + ": material or side");
    check_material(verifier, check, found, ray, *hit, shift / height, where);
}

Check gbuffer(Verifier& verifier, bool jitter) {
    Check check{.stage = jitter ? "gbuffer (jittered)" : "gbuffer",
                .tolerance = "8 eps of the coordinates x triangle's length / height / cosine"};
    std::vector<Surface> found = verifier.found_surfaces();
    const uint sample = 3;
    if (jitter)
        found =
            verifier.trace(verifier.tiles(), {sample, verifier.options().seed, true}).download();
    reference::for_each_pixel(verifier.tiles(), [&](uint x, uint y, std::size_t item) {
        check_surface(verifier, check, found[item], x, y, jitter);
    });
    return check;
}

}  // namespace

StageCheck check_gbuffer() {
    return {.stages = {"gbuffer"},
            .orthographic = true,
            .run = [](Verifier& verifier) -> std::vector<Check> {
                return {gbuffer(verifier, false), gbuffer(verifier, true)};
            }};
}

}  // namespace manylight

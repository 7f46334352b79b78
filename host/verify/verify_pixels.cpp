// SPDX-License-Identifier: MIT
// Stages that work on single pixels: layout and random numbers, gbuffer, accumulate.
#include <algorithm>
#include <array>
#include <cstddef>

#include "reference/accumulate.hpp"
#include "reference/gbuffer.hpp"
#include "reference/random.hpp"
#include "reference/textures.hpp"
#include "reference/tiles.hpp"
#include "reference/triangle.hpp"
#include "shared/adaptive.h"
#include "shared/layout.h"
#include "stages/accumulate.hpp"
#include "verify/tolerances.hpp"
#include "verify/verify.hpp"

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

}  // namespace

Check Verifier::layout() {
    Check check{.stage = "layout", .tolerance = exact};
    std::vector<uint> expected;
    std::vector<std::string> names;
#define EXPECT_FIELD(type, field)              \
    expected.push_back(offsetof(type, field)); \
    names.push_back(#type "." #field);
    SHARED_FIELDS(EXPECT_FIELD)
#undef EXPECT_FIELD
    Buffer<uint> offsets = device_.allocate<uint>(expected.size());
    device_.kernel("probe.cl", "probe_layout", {}, "probe")
        .launch(1, Arguments().set("offsets", offsets));
    const std::vector<uint> found = offsets.download();
    for (std::size_t i = 0; i < expected.size(); ++i)
        check.compare_exact(found[i] == expected[i], fmt::format("{} is at byte {}, not {}",
                                                                 names[i], found[i], expected[i]));
    return check;
}

Check Verifier::random() {
    Check check{.stage = "random", .tolerance = exact};
    const uint count = 4096;
    Buffer<std::array<uint, 4>> bits = device_.allocate<std::array<uint, 4>>(count);
    Buffer<glm::vec2> positions = device_.allocate<glm::vec2>(count);
    device_.kernel("probe.cl", "probe_random", {}, "probe")
        .launch(count, Arguments()
                           .set("count", count)
                           .set("seed", options_.seed)
                           .set("bits", bits)
                           .set("positions", positions));
    const auto found_bits = bits.download();
    const auto found_positions = positions.download();
    for (uint i = 0; i < count; ++i) {
        check.compare_exact(found_bits[i] == reference::random_bits(i, i ^ 5, i * 7, options_.seed),
                            fmt::format("random_bits of item {}", i));
        check.compare_exact(
            glm::dvec2(found_positions[i]) == reference::pixel_position(i / 16, i, options_.seed),
            fmt::format("pixel_position of item {}", i));
    }
    return check;
}

Check Verifier::gbuffer(bool jitter) {
    Check check{.stage = jitter ? "gbuffer (jittered)" : "gbuffer",
                .tolerance = "8 eps of the coordinates x triangle's length / height / cosine"};
    std::vector<Surface> found = found_;
    const uint sample = 3;
    if (jitter) found = trace(tiles_, {sample, options_.seed, true}).download();
    reference::for_each_pixel(tiles_, [&](uint x, uint y, std::size_t item) {
        check_surface(check, found[item], x, y, jitter);
    });
    return check;
}

void Verifier::check_surface(Check& check, const Surface& found, uint x, uint y, bool jitter) {
    const reference::Ray ray = reference::primary_ray(
        camera_, tiles_, reference::sample_point(tiles_, x, y, jitter, 3, options_.seed));
    auto hit = tracer_.closest_hit(ray);
    const std::string where = fmt::format("pixel ({}, {})", x, y);
    const bool found_hit = found.position.w >= 0;
    // Of triangles that meet where the ray does, any is right: it is judged by its own surface.
    if (found_hit && hit && found.triangle != hit->triangle) {
        const auto own = tracer_.hit_near(found.triangle, ray);
        const double rounding = rounding_of(scene_, found.triangle, ray, reach_).position +
                                rounding_of(scene_, hit->triangle, ray, reach_).position;
        if (own && std::abs(own->t - hit->t) <= rounding) hit = own;
    }
    const Surface expected = reference::surface_at(scene_, ray, hit);
    if (found_hit != hit.has_value() || (found_hit && found.triangle != hit->triangle)) {
        // Another triangle is right if a ray that rounding cannot tell apart hits it, and nothing
        // well before it: where two triangles meet, rounding tells which is in front.
        const double shift = 16 * epsilon * reach_;
        for (const reference::Ray& moved :
             reference::Tracer::neighbours(ray, {glm::dvec3(shift), glm::dvec3(2 * shift)})) {
            const auto closest = tracer_.closest_hit(moved);
            if (!found_hit && !closest) return check.skip_borderline();
            if (!found_hit) continue;
            const auto own = tracer_.hit_of(found.triangle, moved);
            if (own && own->t <= closest->t + 64 * shift) return check.skip_borderline();
        }
        check.compare(
            2, 1,
            fmt::format("{}: triangle {} is hit at {}, not {} at {}", where, found.triangle,
                        found.position.w, hit ? hit->triangle : ~0u, hit ? hit->t : -1));
        return;
    }
    if (!found_hit) return check.compare(0, 1, where);
    const auto [height, shift] = rounding_of(scene_, found.triangle, ray, reach_);
    check.compare(glm::length(glm::dvec3(found.position) - glm::dvec3(expected.position)), shift,
                  fmt::format("{}: position {} is not {}", where, show(found.position),
                              show(expected.position)));
    check.compare(
        std::abs(double{found.position.w} - expected.position.w), shift,
        fmt::format("{}: distance {} is not {}", where, found.position.w, expected.position.w));
    const double normal_shift = 16 * epsilon * (1 + reach_ / height);
    // Interpolated normals, by which the horizon may be, turn with the point.
    const double smooth_shift = normal_shift + 4 * shift / height;
    const auto turned = [](const Surface& a, const Surface& b) {
        return glm::length(glm::dvec3(a.horizon) - glm::dvec3(b.horizon));
    };
    // Where the horizon is lifted as far as it has to be at the least, rounding decides.
    if (turned(found, expected) > smooth_shift)
        for (const glm::dvec2& step : steps_of(shift / height)) {
            const reference::Hit moved{hit->triangle, hit->t, hit->u + step.x, hit->v + step.y};
            if (turned(reference::surface_at(scene_, ray, moved), expected) > 16 * smooth_shift)
                return check.skip_borderline();
        }
    check.compare(turned(found, expected), smooth_shift,
                  fmt::format("{}: horizon's normal {} is not {}", where, show(found.horizon),
                              show(expected.horizon)));
    double mapped_shift = 0;  // by what a normal map says nearby
    if (scene_.varies_materials())
        for (const glm::dvec2& step : steps_of(shift / height)) {
            const reference::Hit moved{hit->triangle, hit->t, hit->u + step.x, hit->v + step.y};
            const Surface there = reference::surface_at(scene_, ray, moved);
            mapped_shift += glm::length(glm::dvec3(there.normal) - glm::dvec3(expected.normal));
        }
    check.compare(
        glm::length(glm::dvec3(found.normal) - glm::dvec3(expected.normal)),
        smooth_shift + mapped_shift,
        fmt::format("{}: normal {} is not {}", where, show(found.normal), show(expected.normal)));
    check_offset(check, found, ray, *hit, shift / height, where);
    check.compare_exact(found.material == expected.material && found.front == expected.front,
                        where + ": material or side");
    check_material(check, found, ray, *hit, shift / height, where);
}

// The offset is the bound that it should be, as far as rounding of the normal, of the edges and, by
// `shift`, of the point's weights of vertices lets it, and takes shadow rays off the triangle.
void Verifier::check_offset(Check& check, const Surface& found, const reference::Ray& ray,
                            const reference::Hit& hit, double shift, const std::string& where) {
    const auto horizon = [&](const glm::dvec2& step) {
        const reference::Hit moved{hit.triangle, hit.t, hit.u + step.x, hit.v + step.y};
        return reference::surface_at(scene_, ray, moved).horizon;
    };
    const float4 at = horizon({0, 0});
    const double expected = at.w;
    const reference::Triangle triangle(scene_, hit.triangle);
    const glm::dvec3 normal = glm::normalize(triangle.face()) * (found.front ? 1.0 : -1.0);
    const bool lifted = glm::length(glm::dvec3(at) - normal) > 1e-6;
    double slack = 16 * epsilon * expected;
    if (lifted)
        for (const int k : {1, 2})
            slack += 16 * epsilon * glm::length(triangle.corner(k) - triangle.corner(0));
    for (const glm::dvec2& step : steps_of(shift)) slack += std::abs(horizon(step).w - expected);
    for (int axis = 0; axis < 3; ++axis)
        slack += OFFSET_SCALE * 3 * reach_ *
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
void Verifier::check_material(Check& check, const Surface& found, const reference::Ray& ray,
                              const reference::Hit& hit, double shift, const std::string& where) {
    if (!scene_.varies_materials())
        return check.compare_exact(found.shading == found.material, where + ": shading");
    const auto values = [&](const glm::dvec2& step, double pixel) {
        reference::Ray moved = ray;
        for (int k = 0; k < 2; ++k) {
            moved.origin_change[k] *= pixel;
            moved.direction_change[k] *= pixel;
        }
        return values_of(reference::material_at(
            scene_, moved, {hit.triangle, hit.t, hit.u + step.x, hit.v + step.y}));
    };
    const Values expected = values({0, 0}, 1);
    Values slack{};
    const auto add_slack = [&](const Values& moved) {
        for (std::size_t i = 0; i < slack.size(); ++i) slack[i] += std::abs(moved[i] - expected[i]);
    };
    for (const glm::dvec2& step : steps_of(shift)) add_slack(values(step, 1));
    for (const double pixel : {1 - 1e-5, 1 + 1e-5}) add_slack(values({0, 0}, pixel));
    const Values own = values_of(scene_.materials[found.shading]);
    for (std::size_t i = 0; i < slack.size(); ++i)
        check.compare(
            std::abs(own[i] - expected[i]),
            shading_roundings * epsilon * std::abs(expected[i]) + slack[i],
            fmt::format("{}: material's value {}: {} is not {}", where, i, own[i], expected[i]),
            own[i] == 0 && expected[i] == 0);
}

Check Verifier::accumulate() {
    Check check{.stage = "accumulate", .tolerance = "2 eps of the sum (compensated)"};
    for (const bool grouped : {true, false})
        for (const bool by_passes : {false, true}) accumulate(check, grouped, by_passes);
    return check;
}

// `by_passes`: half of the pixels at a time, as sampler adaptive does.
void Verifier::accumulate(Check& check, bool grouped, bool by_passes) {
    const Tiles tiles =
        by_passes ? middle_tiles(options_.width, options_.height, ADAPTIVE_TILE, 9) : tiles_;
    const Buffer<Surface> surfaces = trace(tiles, {});
    const std::vector<Surface> points = surfaces.download();
    const std::size_t pixels = std::size_t{tiles.width} * tiles.height;
    ImageSum image(device_, pixels, grouped);
    image.sums.upload(std::vector<float4>(pixels, float4(1e6f, 2, 3, 4)));
    AccumulateStage stage(device_, device_scene_, grouped);
    std::vector<glm::dvec4> expected(pixels, glm::dvec4(1e6f, 2, 3, 4));
    std::vector<glm::dvec4> groups(ERROR_GROUPS * pixels, glm::dvec4(0));
    double weights = 0;
    for (uint sample = 0; sample < 5; ++sample) {
        std::vector<float4> estimates(item_count(tiles));
        for (std::size_t i = 0; i < estimates.size(); ++i)
            estimates[i] = float4(0.013f * static_cast<float>((i + 31 * sample) % 97), 2, 1e-6f, 3);
        const float weight = sample < 2 ? 1.f : 4.f;
        const Buffer<float4> uploaded = device_.upload(estimates);
        const SampleWeight weighed{weight, sample % ERROR_GROUPS};
        if (by_passes)
            for (const uint first : {0u, 8u})
                stage.add(tiles, Pass{first, 8, 0, 0, tiles.count, 1}, surfaces, uploaded, weighed,
                          image);
        else
            stage.add(tiles, {}, surfaces, uploaded, weighed, image);
        weights += weight;
        reference::for_each_pixel(tiles, [&](uint x, uint y, std::size_t item) {
            const std::size_t pixel = std::size_t{y} * tiles.width + x;
            const glm::dvec4 value =
                glm::dvec4(weight, weight, weight, 1) *
                reference::pixel_sample_value(points[item], estimates[item], scene_);
            expected[pixel] += value;
            groups[ERROR_GROUPS * pixel + sample % ERROR_GROUPS] +=
                glm::dvec4(glm::dvec3(value), weight);
        });
    }
    const std::vector<float4> found = image.sums.download();
    const std::vector<float4> found_groups =
        grouped ? image.groups.download() : std::vector<float4>{};
    const std::vector<float> found_weights = image.weights.download();
    reference::for_each_pixel(tiles, [&](uint x, uint y, std::size_t) {
        const std::size_t pixel = std::size_t{y} * tiles.width + x;
        const std::string name = fmt::format("pixel ({}, {})", x, y);
        check.compare_exact(found_weights[pixel] == weights, name + ": weight");
        for (int c = 0; c < 4; ++c) {
            check.compare(std::abs(found[pixel][c] - expected[pixel][c]),
                          2 * epsilon * expected[pixel][c], fmt::format("{}, channel {}", name, c));
            if (!grouped) continue;
            for (uint g = 0; g < ERROR_GROUPS; ++g) {
                const double sum = groups[ERROR_GROUPS * pixel + g][c];
                check.compare(std::abs(found_groups[ERROR_GROUPS * pixel + g][c] - sum),
                              4 * epsilon * sum,
                              fmt::format("{}, channel {}: group {}", name, c, g));
            }
        }
    });
}

}  // namespace manylight

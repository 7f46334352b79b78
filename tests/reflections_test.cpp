// SPDX-License-Identifier: MIT
#include "reference/reflections.hpp"
#include "reference/material/ggx.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include "support.hpp"
#include "verify/sampler_checks.hpp"
#include "verify/stages.hpp"

namespace manylight {
namespace {

constexpr double pi = 3.14159265358979;

// The lamps of a scene emit on both sides.
void make_double_sided(Scene& scene) {
    for (Material& material : scene.materials) material.emission.w = 1;
    scene.lights.clear();
    add_emitters(scene, 0);
}

// A smooth floor, a bent plate with normals of its own, a polished box, a rough one, and something
// in between; lamps that are a quad, a triangle and one that leans.
test::TestScene polished_scene() {
    return test::make_scene(
        [](GltfWriter& out) {
            Mesh floor;
            floor.add_quad({-3, 0, 3}, {6, 0, 0}, {0, 0, -6});
            out.add_mesh("floor", floor, out.add_material({0.7f, 0.6f, 0.5f}, 1, 0.12f));
            Mesh bent;
            bent.add_quad({-1.6f, 0.2f, 1}, {1.2f, 0, 0}, {0, 0.5f, -1});
            for (const glm::vec3& n :
                 {glm::vec3(-0.3f, 1, 0.4f), {0.3f, 1, 0.5f}, {0.4f, 1, 0.9f}, {-0.3f, 1, 0.7f}})
                bent.normals.push_back(glm::normalize(n));
            out.add_mesh("bent", bent, out.add_material({0.9f, 0.9f, 0.8f}, 1, 0.04f));
            Mesh polished;
            polished.add_box({0.9f, 0, 0.4f}, {0.8f, 0.5f, 0.8f}, 0.4f);
            out.add_mesh("polished", polished, out.add_material({0.2f, 0.3f, 0.6f}, 0, 0.08f));
            Mesh rough;
            rough.add_box({-0.2f, 0, -1}, {0.6f, 0.9f, 0.5f}, 0.2f);
            rough.add_quad({-0.5f, 1.2f, 0}, {0.7f, 0, 0}, {0, 0.1f, -0.6f});
            out.add_mesh("rough", rough, out.add_material({0.5f, 0.5f, 0.5f}, 0.5f, 0.6f));
            Mesh lamps;
            lamps.add_quad({-1.5f, 1.2f, -2}, {1.6f, 0, 0}, {0, -0.2f, 1});
            lamps.add_triangle({0.4f, 0.5f, -1.5f}, {2, 0.5f, -1.4f}, {0.6f, 1.9f, -1.4f});
            lamps.add_quad({-2, 0.2f, -2}, {4, 0, 0}, {0, 1.4f, 0.2f});
            out.add_mesh("lamps", lamps, out.add_emitter({6, 5, 4}));
            out.add_camera("front", {0.2f, 1.2f, 3}, {-0.1f, 0.3f, 0}, 0.9f, 1.6f);
        },
        40, 25);
}

FrameResult render(const Device& device, const test::TestScene& scene, bool reflections,
                   bool hide_emitters) {
    RenderOptions options;
    options.sampler = "uniform";
    options.light_samples = 64;
    options.spp = 2;
    options.hide_emitters = hide_emitters;
    options.reflections = reflections;
    return test::render(device, scene, options);
}

// A mirror, nearly, that fills the view, and one large lamp that it shows.
test::TestScene mirror_scene(bool facing) {
    return test::make_scene(
        [&](GltfWriter& out) {
            Mesh mirror;
            mirror.add_quad({-1, 0, 1}, {2, 0, 0}, {0, 0, -2});
            out.add_mesh("mirror", mirror, out.add_material({0.9f, 0.8f, 0.7f}, 1, 0.033f));
            Mesh lamp;
            lamp.add_quad({-2, 3, -2}, {4, 0, 0}, {0, 0, 4});
            if (!facing) std::ranges::reverse(lamp.indices);
            out.add_mesh("lamp", lamp, out.add_emitter({3, 2, 1}));
            out.add_camera("down", {0, 2, 0.01f}, {0, 0, 0}, 0.2f, 1);
        },
        16, 16);
}

}  // namespace

// Every lamp one-sided and two-sided, perspective and orthographic cameras; and the light samples,
// which leave it part of the light.
TEST(reflections, agree_with_the_reference) {
    for (const bool both_sides : {false, true}) {
        test::TestScene scene = polished_scene();
        if (both_sides) make_double_sided(scene.scene);
        View view = find_view(scene.scene, "");
        if (both_sides) {
            view.orthographic = true;
            view.half_height = 1.2;
        }
        scene.camera = make_camera(view, scene.width, scene.height);
        VerifyOptions options;
        options.width = scene.width;
        options.height = scene.height;
        options.most_entries = 4000;
        FOR_EACH_DEVICE(device) {
            Verifier verifier(device, scene.scene, scene.camera, options);
            for (const Check& check : check_stage(verifier, "reflections")) {
                test::expect_pass(check);
                EXPECT_GT(check.telling, 30u);
            }
            if (!both_sides) test::expect_pass(check_estimates(verifier, find_sampler("ris")));
        }
    }
}

// The density of directions integrates to 1 over the sphere; and the mean of value over density is
// the integral of the value: of the reflected light's share, and of a function that is not
// symmetric about anything.
TEST(reflections, directions_follow_their_density) {
    std::mt19937 engine(1);
    std::uniform_real_distribution<double> unit;
    for (const float alpha : {0.02f, 0.1f, 0.4f, 1.f})
        for (const double angle : {0.0, 0.7, 1.3, 1.5}) {
            SCOPED_TRACE(fmt::format("alpha {}, {} rad", alpha, angle));
            Material m{};
            m.base_color = float4(1, 1, 1, 1);
            m.reflectance = float4(glm::vec3(USUAL_REFLECTANCE), 0);
            m.roughness = alpha;
            m.specular = 1;
            const glm::dvec3 n = glm::normalize(glm::dvec3(0.3, -0.5, -0.8));
            const glm::dvec3 across = glm::normalize(glm::cross(n, glm::dvec3(0.1, 1, 0.3)));
            const glm::dvec3 wo = std::cos(angle) * n + std::sin(angle) * across;
            const glm::dmat3 frame(across, glm::cross(n, across), n);
            const auto skewed = [&](const glm::dvec3& wi) {
                return 1 + glm::dot(wi, glm::dvec3(0.6, 0.3, -0.2)) + std::sin(9 * wi.x + 5 * wi.y);
            };
            // Over half vectors h, from whose solid angle wi's is 4 wo.h times as large; the sine
            // in steps that grow from the lobe's width.
            double density = 0;
            double reflected = 0;
            double expected_skewed = 0;
            constexpr int steps = 500;
            for (int i = 0; i < steps; ++i)
                for (int j = 0; j < steps; ++j) {
                    const double t = (i + 0.5) / steps;
                    const double tangent = alpha * t / (1 - t);
                    const double cosine = 1 / std::sqrt(1 + tangent * tangent);
                    const double sine = tangent * cosine;
                    const double phi = 2 * pi * (j + 0.5) / steps;
                    const glm::dvec3 h =
                        frame * glm::dvec3(sine * std::cos(phi), sine * std::sin(phi), cosine);
                    if (glm::dot(wo, h) <= 0) continue;
                    const glm::dvec3 wi = 2 * glm::dot(wo, h) * h - wo;
                    // d cosine = sine cosine^2 d tangent
                    const double weight = sine * cosine * cosine * alpha / ((1 - t) * (1 - t)) * 2 *
                                          pi / (steps * steps) * 4 * glm::dot(wo, h);
                    const reference::Brdf f = reference::split_brdf(m, n, wi, wo);
                    density += f.density * weight;
                    reflected += f.specular.x * std::max(glm::dot(n, wi), 0.0) * weight;
                    expected_skewed += f.density * skewed(wi) * weight;
                }
            EXPECT_NEAR(density, 1, 2e-3);
            constexpr int draws = 40'000;
            double sums[2] = {};
            double squares[2] = {};
            for (int i = 0; i < draws; ++i) {
                const glm::dvec3 wi =
                    reference::sample_lobe(alpha, n, wo, {unit(engine), unit(engine)});
                ASSERT_NEAR(glm::length(wi), 1, 1e-9);
                const reference::Brdf f = reference::split_brdf(m, n, wi, wo);
                const double values[2] = {f.specular.x * std::max(glm::dot(n, wi), 0.0) / f.density,
                                          skewed(wi)};
                for (int k = 0; k < 2; ++k) {
                    sums[k] += values[k] / draws;
                    squares[k] += values[k] * values[k] / draws;
                }
            }
            const double expected[2] = {reflected, expected_skewed};
            for (int k = 0; k < 2; ++k)
                EXPECT_NEAR(sums[k], expected[k],
                            5 * std::sqrt((squares[k] - sums[k] * sums[k]) / draws) + 2e-3);
        }
}

// A mirror shows the lamp: its radiance times the mirror's colour, though emitters are hidden; from
// behind if it emits there too, and else nothing.
TEST(reflections, a_mirror_shows_the_lamp) {
    test::TestScene two_sided = mirror_scene(false);
    make_double_sided(two_sided.scene);
    FOR_EACH_DEVICE(device) {
        for (const test::TestScene& scene : {mirror_scene(true), two_sided}) {
            const Image image = render(device, scene, true, true).image;
            double sums[3] = {};
            for (std::size_t i = 0; i < image.values.size(); ++i) sums[i % 3] += image.values[i];
            const auto pixels = static_cast<double>(image.pixel_count());
            EXPECT_NEAR(sums[0] / pixels, 3 * 0.9, 0.1);
            EXPECT_NEAR(sums[1] / pixels, 2 * 0.8, 0.06);
            EXPECT_NEAR(sums[2] / pixels, 1 * 0.7, 0.03);
        }
        for (const float value : render(device, mirror_scene(false), true, true).image.values)
            ASSERT_EQ(value, 0);
    }
}

// Not where no material is smooth enough or emitters are points, nor where they are not wanted; the
// same seed gives the same bits.
TEST(reflections, only_where_they_matter) {
    test::TestScene scene = polished_scene();
    EXPECT_TRUE(find_features(scene.scene).reflections);
    EXPECT_FALSE(find_features(test::scene_named("kinds").scene).reflections);
    FOR_EACH_DEVICE(device) {
        const std::vector<float> image = render(device, scene, true, false).image.values;
        EXPECT_EQ(image, render(device, scene, true, false).image.values);
        EXPECT_NE(image, render(device, scene, false, false).image.values);
    }
    for (Material& material : scene.scene.materials)
        material.roughness = std::max(material.roughness, REFLECTING_ALPHA);
    EXPECT_FALSE(find_features(scene.scene).reflections);
    scene = polished_scene();
    scene.scene.lights.clear();
    scene.scene.light_cells = {};
    add_emitters(scene.scene, 20);
    EXPECT_FALSE(find_features(scene.scene).reflections);
}

}  // namespace manylight

// SPDX-License-Identifier: MIT
// Images whose exact value is known: each expected value is derived in a comment.
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include "reference/shading.hpp"
#include "support.hpp"

namespace manylight {
namespace {

constexpr float pi = glm::pi<float>();

// A Lambert plane y = 0 of albedo 0.6, seen from (0, 3, 0) straight down; the one pixel looks at
// the origin.
test::TestScene plane_under(const std::function<void(GltfWriter&)>& add_lights,
                            unsigned points = 0) {
    return test::make_scene(
        [&](GltfWriter& out) {
            Mesh plane;
            plane.add_quad({-20, 0, 20}, {40, 0, 0}, {0, 0, -40});
            out.add_mesh("plane", plane, out.add_diffuse(glm::vec3(0.6f)));
            add_lights(out);
            out.add_camera("down", {0, 3, 1e-4f}, {0, 0, 0}, 0.001f, 1);
        },
        1, 1, points);
}

float radiance(const Device& device, const test::TestScene& scene, uint spp = 1) {
    RenderOptions options;
    options.sampler = "exhaustive";
    options.spp = spp;
    return test::render(device, scene, options).image.values[0];
}

}  // namespace

// L = albedo / pi * I cos / d^2.
TEST(lights, point_inverse_square_and_cosine) {
    FOR_EACH_DEVICE(device)
    for (const glm::vec3 at : {glm::vec3(0, 1, 0), {0, 2, 0}, {0, 4, 0}, {1, 1, 0}, {2, 1, 1}}) {
        const float d2 = glm::dot(at, at);
        const float expected = 0.6f / pi * 7 * (at.y / std::sqrt(d2)) / d2;
        const test::TestScene scene =
            plane_under([&](GltfWriter& out) { out.add_point(at, glm::vec3(7)); });
        EXPECT_NEAR(radiance(device, scene), expected, 2e-5 * expected);
    }
}

// A range beyond all others is none, for every sampler.
TEST(lights, boundless_ranges) {
    const auto image = [](const Device& device, std::string_view sampler, float range) {
        test::TestScene scene = plane_under([](GltfWriter& out) {
            out.add_point({0, 2, 0}, glm::vec3(7));
        });
        scene.scene.lights[0].axis.w = range;
        RenderOptions options;
        options.sampler = sampler;
        return test::render(device, scene, options).image.values;
    };
    FOR_EACH_DEVICE(device)
    for (const Sampler& sampler : all_samplers())
        EXPECT_EQ(image(device, sampler.name, 3e25f), image(device, sampler.name, 0))
            << sampler.name;
}

// Below the plane: nothing.
TEST(lights, behind_the_surface) {
    const test::TestScene scene = plane_under([](GltfWriter& out) {
        out.add_point({0, -1, 0}, glm::vec3(7));
    });
    FOR_EACH_DEVICE(device) EXPECT_EQ(radiance(device, scene), 0);
}

// L = albedo / pi * E cos.
TEST(lights, directional) {
    const test::TestScene scene = plane_under([](GltfWriter& out) {
        out.add_directional({1, -1, 0}, glm::vec3(3));
    });
    const float expected = 0.6f / pi * 3 / std::sqrt(2.f);
    FOR_EACH_DEVICE(device) EXPECT_NEAR(radiance(device, scene), expected, 2e-5 * expected);
}

// KHR_lights_punctual: attenuation clamp((cos - cos outer) / (cos inner - cos outer))^2, here for a
// spot at (0, 2, 0) that is turned away from the origin by `angle`.
TEST(lights, spot_cone) {
    constexpr float inner = 0.3f;
    constexpr float outer = 0.8f;
    FOR_EACH_DEVICE(device)
    for (const float angle : {0.0f, 0.2f, 0.4f, 0.7f, 0.9f}) {
        const float cone = std::clamp(
            (std::cos(angle) - std::cos(outer)) / (std::cos(inner) - std::cos(outer)), 0.f, 1.f);
        const float expected = 0.6f / pi * 5 / 4 * cone * cone;
        const test::TestScene scene = plane_under([&](GltfWriter& out) {
            out.add_spot({0, 2, 0}, {std::sin(angle), -std::cos(angle), 0}, glm::vec3(5), inner,
                         outer);
        });
        EXPECT_NEAR(radiance(device, scene), expected, 2e-5 * expected + 1e-7);
    }
}

// Beams down to a hundredth of a degree, sharp, nearly so and soft, seen along their axis as a disc
// in an image 1.5 times as wide. The mean of clamp((v_o - v) / (v_o - v_i))^2, v = 1 - cos, over
// directions is (v_i + (v_o - v_i) / 3) / v_o; so close to the axis, all else is the same
// everywhere: albedo / pi * I cos / d^2.
TEST(lights, narrow_beams) {
    const glm::vec3 towards = glm::normalize(glm::vec3(0.1f, -1, 0.2f));
    FOR_EACH_DEVICE(device)
    for (const double degrees : {0.01, 0.25})
        for (const double inner : {0.0, 0.99999, 1.0})
            for (const char* sampler : {"exhaustive", "adaptive", "lighttree"}) {
                const double outer = degrees * M_PI / 180;
                const double radius = 10 * std::tan(outer);
                Scene scene =
                    plane_under([&](GltfWriter& out) {
                        out.add_spot(-10.f * towards, towards, glm::vec3(100),
                                     static_cast<float>(inner * outer), static_cast<float>(outer));
                    }).scene;
                View view;  // along the beam, onto the plane
                view.orthographic = true;
                view.half_height = 1.5 * radius;
                view.to_world = glm::inverse(
                    glm::lookAt(glm::dvec3(-towards), glm::dvec3(0), glm::dvec3(0, 0, 1)));
                const test::TestScene seen{scene, make_camera(view, 96, 96), 96, 96};
                RenderOptions options;
                options.sampler = sampler;
                options.spp = 16;
                options.light_samples = 1;
                double mean = 0;
                const FrameResult result = test::render(device, seen, options);
                for (const float v : result.image.values)
                    mean += v / static_cast<double>(result.image.values.size());
                const double v_o = 1 - std::cos(outer);
                const double v_i = 1 - std::cos(inner * outer);
                const double share = M_PI / 9 * (v_i + (v_o - v_i) / 3) / v_o;
                const double expected = 0.6 / M_PI * 100 / 100 * -double{towards.y} * share;
                EXPECT_NEAR(mean / expected, 1, 1e-3)
                    << degrees << " degrees, inner " << inner << ", " << sampler;
            }
}

// A spot's power, lm, against the integral of its intensity over the sphere.
TEST(lights, spot_power) {
    const test::TestScene scene = plane_under([](GltfWriter& out) {
        out.add_spot({0, 2, 0}, {0, -1, 0}, glm::vec3(5), 0.3f, 0.8f);
    });
    const Light& light = scene.scene.lights[0];
    double integral = 0;
    constexpr int steps = 100000;
    for (int i = 0; i < steps; ++i) {
        const double cosine = -1 + 2 * (i + 0.5) / steps;
        const double cone = std::clamp((light.edge.y - (1 - cosine)) * light.edge.x, 0.0, 1.0);
        integral += 5 * cone * cone * 2 * M_PI * 2 / steps;
    }
    EXPECT_NEAR(light.emission.w, integral, 1e-3 * integral);
}

// The room of a square lamp, and the same a billion times smaller, where its corners' products are
// too small to be squared in single precision.
TEST(lights, nanometres) {
    const auto room = [](float size) {
        return test::make_scene(
            [&](GltfWriter& out) {
                Mesh floor;
                floor.add_quad({-size, 0, size}, {2 * size, 0, 0}, {0, 0, -2 * size});
                out.add_mesh("floor", floor, out.add_diffuse(glm::vec3(0.5f)));
                Mesh lamp;
                lamp.add_quad({-0.05f * size, size, -0.05f * size}, {0.1f * size, 0, 0},
                              {0, 0, 0.1f * size});
                out.add_mesh("lamp", lamp, out.add_emitter(glm::vec3(4)));
                out.add_camera("camera", {0, 1.5f * size, 3 * size}, {0, 0.3f * size, 0}, 0.8f, 1);
            },
            24, 24);
    };
    const test::TestScene usual = room(0.2f);
    const test::TestScene small = room(0.2e-9f);
    for (const unsigned points : {0u, 8u}) {
        test::TestScene a = usual;
        test::TestScene b = small;
        if (points > 0)
            for (test::TestScene* scene : {&a, &b}) {
                scene->scene.lights.clear();
                scene->scene.light_cells = {};
                add_emitters(scene->scene, points);
            }
        EXPECT_EQ(a.scene.lights.size(), b.scene.lights.size());
        FOR_EACH_DEVICE(device)
        for (const char* sampler : {"exhaustive", "adaptive"}) {
            RenderOptions options;
            options.sampler = sampler;
            options.spp = 1;
            const std::vector<float> found = test::render(device, b, options).image.values;
            const std::vector<float> expected = test::render(device, a, options).image.values;
            double difference = 0;
            double sum = 0;
            for (std::size_t i = 0; i < found.size(); ++i) {
                difference += std::abs(found[i] - expected[i]);
                sum += expected[i];
            }
            EXPECT_GT(sum, 1);
            EXPECT_LT(difference, 1e-3 * sum) << sampler << ", " << points << " points";
        }
    }
}

// A one-sided square of side a at height h over the point, parallel to the plane. Lambert's formula
// for a polygon gives E = L / 2 * sum of edge angles * cosines; for this square, by its quarters,
//   E = 4 * L / 2 * (X / sqrt(1 + X^2) * atan(X / sqrt(1 + X^2)) * 2), X = a / (2 h).
TEST(lights, area_against_lamberts_formula) {
    const auto expected = [](double side, double height, double light) {
        const double x = side / (2 * height);
        const double r = x / std::sqrt(1 + x * x);
        return 0.6 / M_PI * 4 * light / 2 * (2 * r * std::atan(r));
    };
    FOR_EACH_DEVICE(device)
    for (const auto& [side, cells] : {std::pair(0.1f, 1u), {1.0f, 16u}, {3.0f, 144u}}) {
        const test::TestScene scene = plane_under([&](GltfWriter& out) {
            Mesh lamp;
            lamp.add_quad({-side / 2, 3.5f, -side / 2}, {side, 0, 0}, {0, 0, side});
            out.add_mesh("lamp", lamp, out.add_emitter(glm::vec3(9)));
        });
        ASSERT_EQ(scene.scene.lights.size(), cells);
        const double value = expected(side, 3.5, 9);
        EXPECT_NEAR(radiance(device, scene, 4096), value, 0.01 * value) << "side " << side;
        // Seen from behind it is dark.
        const test::TestScene back = plane_under([&](GltfWriter& out) {
            Mesh lamp;
            lamp.add_quad({-side / 2, 3.5f, -side / 2}, {0, 0, side}, {side, 0, 0});
            out.add_mesh("lamp", lamp, out.add_emitter(glm::vec3(9)));
        });
        EXPECT_EQ(radiance(device, back, 16), 0);
    }
}

// Lambert's formula for any polygon, E = L / 2 * sum over its edges of the angle that an edge
// subtends times the cosine between the receiver's normal and that of the triangle that the edge
// makes with the receiver: lamps that are tilted and skewed.
TEST(lights, tilted_area_lights_against_lamberts_formula) {
    using Polygon = std::vector<glm::dvec3>;
    const auto expected = [](const Polygon& corners) {
        double sum = 0;
        for (std::size_t i = 0; i < corners.size(); ++i) {
            const glm::dvec3 a = glm::normalize(corners[i]);
            const glm::dvec3 b = glm::normalize(corners[(i + 1) % corners.size()]);
            sum += std::acos(glm::dot(a, b)) * glm::normalize(glm::cross(a, b)).y;
        }
        return 0.6 / M_PI * 9 / 2 * std::abs(sum);
    };
    const glm::dvec3 corner(-0.3, 1, 0.2);
    const glm::dvec3 u(0.1, 0.3, 0.2);
    const glm::dvec3 v(-0.1, 0.4, 0.9);
    const Polygon triangle = {corner, corner + u, corner + v};
    const Polygon parallelogram = {corner, corner + u, corner + u + v, corner + v};
    FOR_EACH_DEVICE(device)
    for (const Polygon& lamp : {triangle, parallelogram})
        for (const bool back : {false, true}) {
            const test::TestScene scene = plane_under([&](GltfWriter& out) {
                Mesh mesh;
                for (std::size_t i = 2; i < lamp.size(); ++i)
                    mesh.add_triangle(lamp[0], lamp[back ? i : i - 1], lamp[back ? i - 1 : i]);
                out.add_mesh("lamp", mesh, out.add_emitter(glm::vec3(9)));
            });
            test::TestScene both = scene;
            for (Light& light : both.scene.lights) light.axis.w = 1;
            const double value = expected(lamp);
            EXPECT_NEAR(radiance(device, both, 4096), value, 0.01 * value) << lamp.size();
            if (back)
                EXPECT_EQ(radiance(device, scene, 16), 0) << lamp.size();
            else
                EXPECT_NEAR(radiance(device, scene, 4096), value, 0.01 * value) << lamp.size();
        }
}

// Two triangles that are a parallelogram but for the tolerance: one light, which lies a little off
// them, and which they do not hide.
TEST(lights, bent_parallelograms_do_not_hide_themselves) {
    const auto lamp = [](float bend) {
        return plane_under([&](GltfWriter& out) {
            Mesh mesh;
            mesh.add_triangle({-0.1f, 3.5f, -0.1f}, {0.1f, 3.5f, -0.1f}, {-0.1f, 3.5f, 0.1f});
            mesh.add_triangle({0.1f, 3.5f, -0.1f}, {0.1f, 3.5f + bend, 0.1f}, {-0.1f, 3.5f, 0.1f});
            out.add_mesh("lamp", mesh, out.add_emitter(glm::vec3(9)));
        });
    };
    const test::TestScene flat = lamp(0);
    for (const float bend : {-7e-5f, 7e-5f}) {
        const test::TestScene bent = lamp(bend);
        ASSERT_EQ(bent.scene.lights.size(), 1u);
        FOR_EACH_DEVICE(device)
        EXPECT_NEAR(radiance(device, bent, 1024), radiance(device, flat, 1024),
                    0.01 * radiance(device, flat, 1024));
    }
}

// As many oriented points as make the square fine: the same light, of the same total power.
TEST(lights, oriented_points_stand_for_the_area) {
    const auto add = [](GltfWriter& out) {
        Mesh lamp;
        lamp.add_quad({-0.5f, 3.5f, -0.5f}, {1, 0, 0}, {0, 0, 1});
        out.add_mesh("lamp", lamp, out.add_emitter({9, 6, 3}));
    };
    const test::TestScene points = plane_under(add, 400);
    const test::TestScene area = plane_under(add);
    ASSERT_EQ(points.scene.lights.size(), 400u);
    float point_power = 0;
    float area_power = 0;
    for (const Light& light : points.scene.lights) {
        point_power += light.emission.w;
        EXPECT_NEAR(light.emission.w, points.scene.lights[0].emission.w, 1e-5);  // equal power
    }
    for (const Light& light : area.scene.lights) area_power += light.emission.w;
    EXPECT_NEAR(point_power, area_power, 1e-4 * area_power);
    FOR_EACH_DEVICE(device)
    EXPECT_NEAR(radiance(device, points), radiance(device, area, 4096),
                0.01 * radiance(device, points));
}

// Emitters of two colours: each point has its emitter's colour, and their number follows power.
TEST(lights, oriented_points_follow_power) {
    const test::TestScene scene = plane_under(
        [](GltfWriter& out) {
            Mesh small;
            small.add_quad({-2, 3.5f, 0}, {1, 0, 0}, {0, 0, 1});
            Mesh large;
            large.add_quad({1, 3.5f, 0}, {1, 0, 0}, {0, 0, 3});
            out.add_mesh("small", small, out.add_emitter(glm::vec3(2)));
            out.add_mesh("large", large, out.add_emitter(glm::vec3(2)));
        },
        40);
    int on_small = 0;
    for (const Light& light : scene.scene.lights) on_small += light.position.x < 0;
    EXPECT_EQ(on_small, 10);
}

// Furnace: a white Lambert plane under directional lights that fill the hemisphere evenly with
// radiance 1 (illuminance of each: its solid angle) reflects radiance 1.
TEST(lights, furnace_of_all_visible_lights) {
    const test::TestScene scene = test::make_scene(
        [](GltfWriter& out) {
            Mesh plane;
            plane.add_quad({-20, 0, 20}, {40, 0, 0}, {0, 0, -40});
            out.add_mesh("plane", plane, out.add_diffuse(glm::vec3(1)));
            constexpr int rings = 24;
            constexpr int spokes = 32;
            for (int i = 0; i < rings; ++i)
                for (int j = 0; j < spokes; ++j) {
                    const float cosine = (static_cast<float>(i) + 0.5f) / rings;
                    const float sine = std::sqrt(1 - cosine * cosine);
                    const float angle = 2 * pi * static_cast<float>(j) / spokes;
                    out.add_directional({sine * std::cos(angle), -cosine, sine * std::sin(angle)},
                                        glm::vec3(2 * pi / (rings * spokes)));
                }
            out.add_camera("down", {0, 3, 1e-4f}, {0, 0, 0}, 0.001f, 1);
        },
        1, 1);
    FOR_EACH_DEVICE(device) EXPECT_NEAR(radiance(device, scene), 1, 1e-4);
}

// The range of KHR_lights_punctual: I clamp(1 - (d / range)^4) / d^2. The writer has no ranges, so
// the light is given one here.
TEST(lights, range) {
    test::TestScene scene = plane_under([](GltfWriter& out) {
        out.add_point({0, 2, 0}, glm::vec3(7));
    });
    FOR_EACH_DEVICE(device)
    for (const float range : {1.5f, 2.5f, 10.f}) {
        scene.scene.lights[0].axis.w = range;
        const float window = std::max(1 - std::pow(2 / range, 4.f), 0.f);
        const float expected = 0.6f / pi * 7 / 4 * window;
        EXPECT_NEAR(radiance(device, scene), expected, 2e-5 * expected + 1e-7);
    }
}

// The reference's BRDF is reciprocal, and metal reflects no more than it receives: white metal
// loses only what scatters more than once. (glTF's mix of diffuse and specular takes Fresnel's term
// of each direction alone and may reflect up to 1.2 at grazing angles.)
TEST(lights, reference_brdf_is_physical) {
    const glm::dvec3 n(0, 0, 1);
    for (const float alpha : {0.05f, 0.3f, 1.0f})
        for (const float metallic : {0.f, 0.5f, 1.f})
            for (const double angle : {0.1, 0.8, 1.3}) {
                Material m{};
                m.base_color = float4(1, 1, 1, metallic);
                m.reflectance = float4(glm::vec3(USUAL_REFLECTANCE), 0);
                m.roughness = alpha;
                m.specular = 1;
                const glm::dvec3 wo(std::sin(angle), 0, std::cos(angle));
                double sum = 0;
                constexpr int steps = 400;
                for (int i = 0; i < steps; ++i)
                    for (int j = 0; j < steps; ++j) {
                        const double cosine = (i + 0.5) / steps;
                        const double sine = std::sqrt(1 - cosine * cosine);
                        const double phi = 2 * M_PI * (j + 0.5) / steps;
                        const glm::dvec3 wi(sine * std::cos(phi), sine * std::sin(phi), cosine);
                        const glm::dvec3 f = reference::brdf(m, n, wi, wo);
                        sum += f.x * cosine * 2 * M_PI / (steps * steps);
                        if (i % 100 == 7 && j % 100 == 7) {
                            EXPECT_NEAR(f.x, reference::brdf(m, n, wo, wi).x, 1e-9 * f.x + 1e-12);
                        }
                    }
                EXPECT_LT(sum, metallic == 1 ? 1.001 : 1.2)
                    << alpha << " " << metallic << " " << angle;
                EXPECT_GT(sum, 0.3) << alpha << " " << metallic << " " << angle;
            }
}

}  // namespace manylight

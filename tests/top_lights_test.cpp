// SPDX-License-Identifier: MIT
#include "explain/top_lights.hpp"

#include <cmath>

#include "support.hpp"

namespace manylight {
namespace {

double mean_luminance(const Image& image) {
    double sum = 0;
    for (std::size_t i = 0; i < image.pixel_count(); ++i) {
        const float* rgb = image.values.data() + 3 * i;
        sum += luminance({rgb[0], rgb[1], rgb[2]});
    }
    return sum / static_cast<double>(image.pixel_count());
}

double rendered(const test::TestScene& scene) {
    RenderOptions options;
    options.sampler = "exhaustive";
    options.hide_emitters = true;
    options.spp = 8;
    return mean_luminance(test::render(test::devices().back(), scene, options).image);
}

TopLights find(const test::TestScene& scene, unsigned count, unsigned seed = 0) {
    return find_top_lights(scene.scene, scene.camera, scene.width, scene.height, count, seed);
}

}  // namespace

// Lights of every kind, each rendered alone.
TEST(top_lights, shares_are_those_of_images_of_one_light) {
    const test::TestScene& scene = test::scene_named("kinds");
    const auto count = static_cast<unsigned>(scene.scene.lights.size());
    const TopLights found = find(scene, count);
    EXPECT_EQ(found.light_samples, 0u);  // all are evaluated
    ASSERT_EQ(found.lights.size(), count);
    const double total = rendered(scene);
    EXPECT_NEAR(found.luminance, total, 0.03 * total);
    double sum = 0;
    for (std::size_t i = 0; i < count; ++i) {
        sum += found.lights[i].share;
        EXPECT_LE(found.lights[i].share, found.lights[i > 0 ? i - 1 : 0].share);
        if (i % 4 != 0) continue;
        test::TestScene alone = scene;
        alone.scene.lights = {scene.scene.lights[found.lights[i].light]};
        EXPECT_NEAR(found.lights[i].share, rendered(alone) / total,
                    4 * found.lights[i].standard_error + 0.001)
            << i;
    }
    EXPECT_NEAR(sum, 1, 1e-9);
}

// Drawn candidates and total against all lights, evaluated: the same points, so no other errors
// than those of the draws.
TEST(top_lights, draws_agree_with_all_lights) {
    const test::TestScene& scene = test::scene_named("many");
    const TopLights all = find(scene, 700);
    const TopLights drawn = find(scene, 20);
    EXPECT_EQ(all.light_samples, 0u);
    EXPECT_GT(drawn.light_samples, 0u);
    EXPECT_NEAR(drawn.luminance, all.luminance, 0.02 * all.luminance);
    ASSERT_EQ(drawn.lights.size(), 20u);
    EXPECT_LT(drawn.shadow_rays, all.shadow_rays);
    int common = 0;
    for (std::size_t i = 0; i < 20; ++i) {
        const auto same = std::ranges::find(all.lights, drawn.lights[i].light, &TopLight::light);
        ASSERT_NE(same, all.lights.end());
        common += same - all.lights.begin() < 20;
        EXPECT_NEAR(drawn.lights[i].share, same->share, 0.03 * same->share);
        EXPECT_EQ(drawn.lights[i].seen, same->seen);
    }
    EXPECT_GE(common, 15);
}

// Over seeds, shares vary as the standard error says, or less.
TEST(top_lights, standard_errors_are_honest) {
    const test::TestScene& scene = test::scene_named("points");
    const std::size_t light = find(scene, 5).lights[0].light;
    double count = 0;
    double sum = 0;
    double squares = 0;
    double expected = 0;
    for (uint seed = 1; seed <= 20; ++seed) {
        const TopLights found =
            find_top_lights(scene.scene, scene.camera, 24, 15, 5, seed);  // few points
        const auto own = std::ranges::find(found.lights, light, &TopLight::light);
        if (own == found.lights.end()) continue;
        count += 1;
        sum += own->share;
        squares += own->share * own->share;
        expected += own->standard_error;
    }
    EXPECT_GE(count, 18);
    const double deviation = std::sqrt(squares / count - std::pow(sum / count, 2));
    EXPECT_LT(deviation, 1.5 * expected / count);
    EXPECT_GT(deviation, 0.2 * expected / count);
}

TEST(top_lights, where_a_light_is_seen) {
    const test::TestScene scene = test::make_scene([](GltfWriter& out) {
        Mesh plane;
        plane.add_quad({-5, 0, 5}, {10, 0, 0}, {0, 0, -10});
        out.add_mesh("plane", plane, out.add_diffuse(glm::vec3(0.5f)));
        out.add_point({0, 2, 0}, glm::vec3(1));
        out.add_point({0, -2, 0}, glm::vec3(100));  // below
        out.add_camera("down", {0, 3, 1e-4f}, {0, 0, 0}, 0.5f, 1);
    });
    const TopLights found = find(scene, 2);
    ASSERT_EQ(found.lights.size(), 2u);
    EXPECT_EQ(found.lights[0].light, 0u);
    EXPECT_EQ(found.lights[0].seen, 1);
    EXPECT_EQ(found.lights[0].share, 1);
    EXPECT_EQ(found.lights[1].seen, 0);
    EXPECT_EQ(found.lights[1].share, 0);
    test::TestScene dark = scene;
    dark.scene.lights.clear();
    EXPECT_TRUE(find(dark, 2).lights.empty());
}

}  // namespace manylight

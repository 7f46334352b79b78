// SPDX-License-Identifier: MIT
#include "output/error_estimate.hpp"

#include <cmath>

#include "output/metrics.hpp"
#include "support.hpp"

namespace manylight {

// Two pixels, of which one has a pair of samples and one more besides.
TEST(error_estimate, follows_its_formula) {
    Image image(2, 1, {"R", "G", "B"});
    image.values = {2, 2, 2, 4, 4, 4};
    const ErrorEstimate e = estimate_error(image, {float4(0.6f, 0, 0, 2), float4(0)}, {3, 3});
    const double scale = 0.5 / 3;
    const double red = scale * scale * (0.36 / (2 * 3)) / (scale * scale * 4 + 0.01);
    EXPECT_NEAR(e.pixels.values[0], red, 1e-6 * red);
    EXPECT_EQ(e.pixels.values[1], 0);
    EXPECT_NEAR(e.relmse, red / 3 / 2, 1e-6 * red);
    EXPECT_NEAR(e.standard_error, red / 3 / 2, 1e-6 * red);
}

TEST(error_estimate, of_a_black_image_is_zero) {
    const Image image(3, 2, {"R", "G", "B"});
    const ErrorEstimate e =
        estimate_error(image, std::vector<float4>(6, float4(0)), std::vector<float>(6, 4));
    EXPECT_EQ(e.relmse, 0);
    EXPECT_EQ(e.pixels.values, image.values);
}

// What images say of their errors is what these are, on average: with pixel samples all alike, and
// with later ones that take more light samples and count more.
TEST(error_estimate, is_the_error) {
    FOR_EACH_DEVICE(device) {
        const test::TestScene& scene = test::scene_named("points");
        RenderOptions exhaustive;
        exhaustive.sampler = "exhaustive";
        exhaustive.spp = 1;
        const Image truth = test::render(device, scene, exhaustive).image;
        for (const std::string_view sampler : {"power", "adaptive"})
            for (const uint spp : {8u, 7u}) {
                SCOPED_TRACE(fmt::format("{}, {} spp", sampler, spp));
                RenderOptions options;
                options.sampler = sampler;
                options.spp = spp;
                options.pixel_centre = true;
                options.aovs = {"error"};
                double estimated = 0;
                double found = 0;
                for (options.seed = 0; options.seed < 12; ++options.seed) {
                    const FrameResult result = test::render(device, scene, options);
                    ASSERT_TRUE(result.error);
                    EXPECT_EQ(result.spp, spp);
                    EXPECT_EQ(result.light_samples, 4u);
                    EXPECT_EQ(result.later_light_samples, 16u);
                    EXPECT_GT(result.error->standard_error, 0);
                    estimated += result.error->relmse;
                    found += compare_images(result.image, truth, "image", "truth").relmse;
                }
                EXPECT_NEAR(estimated / found, 1, spp == 8 ? 0.1 : 0.4);
            }
    }
}

// It is what stops a render, and the image then has about that error.
TEST(error_estimate, stops_a_render) {
    FOR_EACH_DEVICE(device) {
        const test::TestScene& scene = test::scene_named("points");
        RenderOptions options;
        options.sampler = "lighttree";
        options.pixel_centre = true;
        options.spp = 1024;
        options.target_error = 0.002;
        const FrameResult result = test::render(device, scene, options);
        ASSERT_TRUE(result.error);
        EXPECT_LE(result.error->relmse, 0.002);
        EXPECT_GT(result.error->relmse, 0.0005);
        EXPECT_GT(result.spp, 4);
        EXPECT_LT(result.spp, 1024);
        options.target_error = 1e9;
        EXPECT_EQ(test::render(device, scene, options).spp, 4);
        options.target_error = 1e-12;
        options.spp = 6;
        EXPECT_EQ(test::render(device, scene, options).spp, 6);
    }
}

// A deadline that is over leaves one sample of every pixel, whatever the sampler.
TEST(error_estimate, a_missed_deadline_leaves_one_sample) {
    FOR_EACH_DEVICE(device)
    for (const std::string_view sampler : {"uniform", "contribution", "adaptive"}) {
        const test::TestScene& scene = test::scene_named("oriented");
        RenderOptions options;
        options.sampler = sampler;
        options.spp = 1024;
        options.deadline = Clock::now();
        const FrameResult result = test::render(device, scene, options);
        EXPECT_EQ(result.spp, 1) << sampler;
        EXPECT_EQ(result.primary_rays,
                  std::size_t{sampler == "contribution" ? 2u : 1u} * scene.width * scene.height);
    }
}

}  // namespace manylight

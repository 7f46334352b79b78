// SPDX-License-Identifier: MIT
// Samplers ward and ward-unbiased: what their parameters promise.
#include <cmath>
#include <random>

#include "support.hpp"

namespace manylight {
namespace {

RenderOptions options_for(std::string_view sampler, double tau, double certainty = 1) {
    RenderOptions options;
    options.sampler = sampler;
    options.parameters = {{"tau", tau}, {"certainty", certainty}};
    options.light_samples = 4;
    options.spp = 1;
    options.pixel_centre = true;
    return options;
}

FrameResult render_all(const Device& device, const test::TestScene& scene) {
    RenderOptions options;
    options.sampler = "exhaustive";
    options.spp = 1;
    options.pixel_centre = true;
    return test::render(device, scene, options);
}

double luminance_of(const Image& image, std::size_t pixel) {
    const float* p = image.values.data() + 3 * pixel;
    return luminance(glm::vec3(p[0], p[1], p[2]));
}

// The largest error of a pixel's luminance, relative to what it should be.
double largest_error(const Image& found, const Image& exact) {
    double largest = 0;
    for (std::size_t i = 0; i < exact.pixel_count(); ++i) {
        const double expected = luminance_of(exact, i);
        const double error = std::abs(luminance_of(found, i) - expected);
        if (error > 0) largest = std::max(largest, error / expected);
    }
    return largest;
}

// A floor under a bank of `count` equal dim lamps around a bright one. A wall in between stops the
// dim ones' light over a part `hidden` of the floor's width; 0: there is no wall.
test::TestScene bank(int count, float hidden, unsigned size = 32) {
    return test::make_scene(
        [&](GltfWriter& out) {
            Mesh floor;
            floor.add_quad({-1, 0, 1}, {2, 0, 0}, {0, 0, -2});
            if (hidden > 0) floor.add_quad({-20, 1, 20}, {20 + 2 * hidden - 1, 0, 0}, {0, 0, -40});
            out.add_mesh("floor", floor, out.add_diffuse(glm::vec3(0.5f)));
            out.add_point({0, 0.9f, 0}, glm::vec3(2));
            std::minstd_rand random(7);
            std::uniform_real_distribution<float> place(-0.3f, 0.3f);
            for (int i = 0; i < count; ++i) {
                const float x = place(random);
                out.add_point({x, 6, place(random)}, glm::vec3(60.f / static_cast<float>(count)));
            }
            out.add_camera("above", {0, 0.95f, 0.3f}, {0, 0, 0}, 1.4f, 1);
        },
        size, size);
}

// Of many seeds, the smallest probability that a pixel's mean difference from the image of all
// lights is by chance, times the number of pixels. Lights with area have the same points in both
// images.
double probability(const Device& device, const test::TestScene& scene, RenderOptions options,
                   int seeds) {
    RenderOptions all = options;
    all.sampler = "exhaustive";
    all.parameters = {};
    const std::size_t pixels = std::size_t{scene.width} * scene.height;
    std::vector<double> sums(pixels), squares(pixels), expected(pixels);
    for (int seed = 1; seed <= seeds; ++seed) {
        options.seed = all.seed = static_cast<uint>(seed);
        const Image image = test::render(device, scene, options).image;
        const Image exact = test::render(device, scene, all).image;
        for (std::size_t i = 0; i < pixels; ++i) {
            const double difference = luminance_of(image, i) - luminance_of(exact, i);
            sums[i] += difference;
            squares[i] += difference * difference;
            expected[i] += luminance_of(exact, i) / seeds;
        }
    }
    double smallest = 1;
    for (std::size_t i = 0; i < pixels; ++i) {
        const double mean = sums[i] / seeds;
        const double variance = std::max(squares[i] / seeds - mean * mean, 0.0) / (seeds - 1);
        const double rounding = 1e-6 * expected[i] + 1e-9;
        if (std::abs(mean) <= rounding) continue;
        const double t = mean / std::max(std::sqrt(variance), rounding);
        smallest =
            std::min(smallest, static_cast<double>(pixels) * test::student_tail(t, seeds - 1));
    }
    return smallest;
}

}  // namespace

// All lights are tested: also lights with area, whose points are the same, and so many lights that
// an image is more than one slice.
TEST(ward, tests_all_lights_where_tau_is_0) {
    FOR_EACH_DEVICE(device)
    for (const std::string_view sampler : {"ward", "ward-unbiased"}) {
        for (const std::string name : {"points", "kinds", "oriented"}) {
            SCOPED_TRACE(fmt::format("{} on {}", sampler, name));
            const test::TestScene& scene = test::scene_named(name);
            const Image exact = render_all(device, scene).image;
            for (const double certainty : {0.0, 0.5, 1.0})
                EXPECT_LT(largest_error(
                              test::render(device, scene, options_for(sampler, 0, certainty)).image,
                              exact),
                          1e-5);
        }
        const test::TestScene large = bank(2000, 0.5f);
        EXPECT_LT(largest_error(test::render(device, large, options_for(sampler, 0)).image,
                                render_all(device, large).image),
                  1e-5);
    }
}

// The error is below what was left out, which is below tau times what was seen.
TEST(ward, error_is_bounded_where_certainty_is_1) {
    FOR_EACH_DEVICE(device)
    for (const std::string name : {"points", "oriented", "many"})
        for (const double tau : {0.1, 0.4, 1.0}) {
            SCOPED_TRACE(fmt::format("{}, tau {}", name, tau));
            const test::TestScene& scene = test::scene_named(name);
            const double error =
                largest_error(test::render(device, scene, options_for("ward", tau)).image,
                              render_all(device, scene).image);
            EXPECT_LT(error, tau * 1.0001);
            EXPECT_GT(error, 1e-4);  // something was left out
        }
}

// What a certainty of 0 loses where many lights are alike: none of them is below tau alone.
TEST(ward, error_has_no_bound_where_certainty_is_0) {
    const Device& device = test::devices().front();
    const test::TestScene scene = bank(300, 0.5f);
    const Image exact = render_all(device, scene).image;
    const auto error = [&](double certainty) {
        return largest_error(
            test::render(device, scene, options_for("ward", 0.05, certainty)).image, exact);
    };
    EXPECT_GT(error(0), 0.1);
    EXPECT_LT(error(1), 0.05);
}

TEST(ward, rays_fall_as_tau_grows) {
    FOR_EACH_DEVICE(device)
    for (const std::string name : {"points", "kinds", "many"})
        for (const double certainty : {0.0, 0.5, 1.0}) {
            SCOPED_TRACE(fmt::format("{}, certainty {}", name, certainty));
            std::size_t before = std::numeric_limits<std::size_t>::max();
            for (const double tau : {0.0, 0.01, 0.05, 0.2, 1.0}) {
                const std::size_t rays = test::render(device, test::scene_named(name),
                                                      options_for("ward", tau, certainty))
                                             .shadow_rays;
                EXPECT_LT(rays, before) << "tau " << tau;
                before = rays;
            }
        }
}

// More certainty takes more rays, for a smaller error.
TEST(ward, rays_grow_with_certainty) {
    const Device& device = test::devices().front();
    std::size_t before = 0;
    for (const double certainty : {0.0, 0.3, 0.6, 1.0}) {
        const std::size_t rays =
            test::render(device, test::scene_named("many"), options_for("ward", 0.05, certainty))
                .shadow_rays;
        EXPECT_GT(rays, before) << "certainty " << certainty;
        before = rays;
    }
}

// Lights that no pixel of a tile sees are hardly added, those that all see are added whole.
TEST(ward, untested_lights_follow_their_histories) {
    FOR_EACH_DEVICE(device)
    for (const float hidden : {0.f, 1.f}) {
        const test::TestScene scene = bank(100, hidden);
        const double error =
            largest_error(test::render(device, scene, options_for("ward", 1)).image,
                          render_all(device, scene).image);
        EXPECT_LT(error, hidden > 0 ? 0.1 : 2e-3) << hidden;
    }
}

// Renders that go on with each other.
struct Session {
    const Device& device;
    const test::TestScene& scene;
    WideBvh bvh = build_wide_bvh(scene.scene, device.form().bvh_width, device.form().bvh_width,
                                 reach_of(scene.scene, scene.camera));
    FrameState state = {};  // that was saved last

    [[nodiscard]] RenderOptions sized(RenderOptions options) const {
        options.width = scene.width;
        options.height = scene.height;
        return options;
    }
    [[nodiscard]] Frame frame(const RenderOptions& options) const {
        return {device, scene.scene, bvh, scene.camera, options};
    }
    FrameResult render(const RenderOptions& options, const FrameState* from = nullptr) {
        Frame frame = this->frame(options);
        frame.prepare();
        Progress quiet("", true);
        return frame.render(quiet, {.save = [&](const FrameState& saved) { state = saved; }}, from);
    }
};

// A render that is resumed does not probe again, from another pixel sample's surfaces.
TEST(ward, resumed_renders_keep_their_histories) {
    Session session{test::devices().front(), test::scene_named("many")};
    RenderOptions options = session.sized(options_for("ward", 0.5));
    options.pixel_centre = false;
    options.spp = 2;
    (void)session.render(options);
    const FrameState half = session.state;
    options.spp = 4;
    const FrameResult resumed = session.render(options, &half);
    const FrameResult whole = session.render(options);
    EXPECT_EQ(resumed.image.values, whole.image.values);
    EXPECT_EQ(resumed.shadow_rays, whole.shadow_rays);
}

// Batches that are visited in rounds are begun with the same surfaces as an image of one batch.
TEST(ward, histories_do_not_depend_on_batches) {
    Session session{test::devices().front(), test::scene_named("points")};
    for (const std::string_view sampler : {"ward", "ward-unbiased"}) {
        RenderOptions options = session.sized(options_for(sampler, 0.5));
        options.pixel_centre = false;
        options.target_error = 1e-9;
        options.clusters.tile_size = 8;
        options.spp = 256;
        options.spp = Schedule(options, Plan{}, 1).first_round(0).end + 2;  // a second round
        const FrameResult whole = session.render(options);
        options.memory = session.frame(options).plan().total_bytes() - 1;
        ASSERT_EQ(session.frame(options).plan().batches, 2u);
        const FrameResult parts = session.render(options);
        EXPECT_EQ(whole.spp, parts.spp);
        EXPECT_EQ(whole.image.values, parts.image.values);
    }
}

// Where histories are wrong, at the edge of a shadow in a tile, and few lights are tested: the
// sampler that samples the rest is right on average, the one that guesses is not.
TEST(ward, the_tail_is_sampled_without_bias) {
    const Device& device = test::devices().front();
    const test::TestScene scene = bank(40, 0.5f, 24);
    for (const double certainty : {0.0, 1.0})
        for (const uint light_samples : {1u, 3u, 24u}) {
            RenderOptions options = options_for("ward-unbiased", 0.5, certainty);
            options.light_samples = light_samples;
            EXPECT_GT(probability(device, scene, options, 200), 1e-3)
                << certainty << ", " << light_samples << " light samples";
        }
    EXPECT_LT(probability(device, scene, options_for("ward", 0.5), 20), 1e-6);
}

// Lights with area have one point per pixel sample, whether they are tested or drawn: given that,
// what is tested may depend on what is visible of them.
TEST(ward, the_tail_of_area_lights_is_sampled_without_bias) {
    const Device& device = test::devices().front();
    test::TestScene scene = test::scene_named("kinds");
    scene.width = 20;
    scene.height = 12;
    scene.camera = make_camera(find_view(scene.scene, ""), scene.width, scene.height);
    for (const double tau : {0.2, 1.0}) {
        RenderOptions options = options_for("ward-unbiased", tau, 0);
        options.light_samples = 2;
        options.spp = 4;
        EXPECT_GT(probability(device, scene, options, 200), 1e-3) << tau;
        options.sampler = "ward";
        EXPECT_LT(probability(device, scene, options, 100), 1e-6) << tau;
    }
}

}  // namespace manylight

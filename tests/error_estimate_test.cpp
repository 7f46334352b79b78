// SPDX-License-Identifier: MIT
#include "output/error_estimate.hpp"

#include <cmath>
#include <numeric>
#include <random>

#include "output/metrics.hpp"
#include "statistics.hpp"
#include "support.hpp"

namespace manylight {
namespace {

constexpr float nan = std::numeric_limits<float>::quiet_NaN();

// Images of independent pixel samples whose distribution is known.
class Process {
  public:
    explicit Process(uint samples) : truth(size, size, {"R", "G", "B"}), samples_(samples) {}
    virtual ~Process() = default;

    // The estimate of one image, and its true error.
    std::pair<std::optional<ErrorEstimate>, double> draw() {
        std::vector<float4> groups(ERROR_GROUPS * truth.pixel_count(), float4(0));
        Image image = truth;
        for (std::size_t i = 0; i < truth.pixel_count(); ++i) {
            for (uint s = 0; s < samples_; ++s)
                groups[ERROR_GROUPS * i + s % ERROR_GROUPS] += float4(glm::vec3(sample(i)), 1);
            glm::vec4 sum(0);
            for (uint g = 0; g < ERROR_GROUPS; ++g) sum += glm::vec4(groups[ERROR_GROUPS * i + g]);
            for (int c = 0; c < 3; ++c) image.values[3 * i + c] = sum[c] / sum.w;
        }
        return {estimate_error(size, size, groups),
                compare_images(image, truth, "image", "truth").relmse};
    }

    static constexpr unsigned size = 24;
    Image truth;

  protected:
    virtual float sample(std::size_t pixel) = 0;
    std::mt19937 random_{1};

  private:
    uint samples_;
};

// Normal noise of half of each value on a slope of brightness.
struct Slope : Process {
    explicit Slope(uint samples) : Process(samples) {
        for (std::size_t i = 0; i < truth.values.size(); ++i)
            truth.values[i] = 0.1f + static_cast<float>(i / 3 % size) * 0.05f;
    }
    float sample(std::size_t pixel) override {
        return truth.values[3 * pixel] * std::normal_distribution<float>(1, 0.5f)(random_);
    }
};

// Every fourth column of a bright image shows a dark edge: samples meet it with a chance.
struct Edges : Process {
    explicit Edges(uint samples) : Process(samples) {
        for (std::size_t i = 0; i < truth.pixel_count(); ++i)
            for (int c = 0; c < 3; ++c) truth.values[3 * i + c] = chance(i);
    }
    static float chance(std::size_t pixel) {
        const std::size_t column = pixel % size;
        if (column % 4 > 0) return column % 4 == 2 ? 0.01f : 1;
        return 0.2f + 0.6f * static_cast<float>(pixel / size) / size;
    }
    float sample(std::size_t pixel) override {
        const float p = chance(pixel);
        if (p <= 0.01f || p == 1) return p;
        return std::bernoulli_distribution(p)(random_) ? 1.f : 0.f;
    }
};

// An even image of which each sample sees little or much.
struct Sparks : Process {
    explicit Sparks(uint samples) : Process(samples) { std::ranges::fill(truth.values, 1.f); }
    float sample(std::size_t) override {
        return std::bernoulli_distribution(0.3)(random_) ? 2.4f : 0.4f;
    }
};

}  // namespace

// One pixel has no neighbours to be compared with: halves and the jackknife alone, by hand.
TEST(error_estimate, follows_its_formula) {
    for (const unsigned groups : {2u, 3u, 4u}) {
        const std::vector<double> means = {0.1, 3, 0.3, 0.2};
        std::vector<float4> sums(ERROR_GROUPS, float4(0));
        for (unsigned g = 0; g < groups; ++g)
            sums[g] = float4(glm::vec3(static_cast<float>(5 * means[g])), 5);
        const auto mean_of_all = [](const std::vector<double>& v) {
            return std::accumulate(v.begin(), v.end(), 0.0) / static_cast<double>(v.size());
        };
        const std::vector<double> all(means.begin(), means.begin() + groups);
        const double scale = 0.5 / mean_of_all(all);
        // The variance that the mean of so many as all would have.
        const auto error = [&](const std::vector<double>& v) {
            const double mean = mean_of_all(v);
            double squares = 0;
            for (const double x : v) squares += (x - mean) * (x - mean);
            const double variance = squares / static_cast<double>(v.size() - 1) / groups;
            return scale * scale * variance / (scale * scale * mean * mean + 0.01);
        };
        // Two halves: even groups against odd ones.
        const double n = groups < 3 ? 1 : 2;
        const double m = groups < 4 ? 1 : 2;
        const double difference = (n == 1 ? 0.1 : 0.2) - (m == 1 ? 3 : 1.6);
        const double variance = n * m * difference * difference / (n + m) / groups;
        const double level = scale * mean_of_all(all);
        const double plain = scale * scale * variance / (level * level + 0.01);
        double correction = 1;
        if (groups > 2) {
            double jackknife = groups * error(all);
            for (unsigned g = 0; g < groups; ++g) {
                std::vector<double> v = all;
                v.erase(v.begin() + g);
                jackknife -= error(v) * (groups - 1) / groups;
            }
            correction = jackknife / error(all);
            EXPECT_GT(correction, 1.01);
        }
        const auto e = estimate_error(1, 1, sums);
        ASSERT_TRUE(e) << groups;
        EXPECT_NEAR(e->relmse, correction * plain, 1e-6 * e->relmse) << groups;
        EXPECT_NEAR(e->standard_error, e->relmse * std::hypot(std::sqrt(2.), 1 - 1 / correction),
                    1e-6 * e->relmse)
            << groups;
        EXPECT_NEAR(e->pixels.values[1], e->relmse, 1e-6 * e->relmse) << groups;
    }
}

// An estimate that cannot be made is none, and none is not zero.
TEST(error_estimate, of_nothing_is_none) {
    EXPECT_FALSE(estimate_error(2, 1, std::vector<float4>(8, float4(0))));           // no samples
    EXPECT_FALSE(estimate_error(2, 1, std::vector<float4>(8, float4(0, 0, 0, 1))));  // black
    std::vector<float4> one(8, float4(0));
    one[0] = one[4] = float4(1, 2, 3, 1);
    EXPECT_FALSE(estimate_error(2, 1, one));
    EXPECT_FALSE(estimate_error(1, 1, std::vector<float4>(4, float4(nan, 1, 1, 1))));
}

// What has one sample is as noisy as the others are for their weight: it counts in the mean.
TEST(error_estimate, pixels_of_one_group_are_as_noisy_as_others) {
    std::vector<float4> groups(3 * ERROR_GROUPS, float4(0));
    groups[0] = groups[1] = float4(3, 3, 3, 3);
    groups[2] = float4(6, 6, 6, 3);
    groups[4] = float4(1, 1, 1, 1);
    std::fill_n(groups.begin() + 8, 4, float4(1, nan, 1, 1));
    const auto e = estimate_error(3, 1, groups);
    ASSERT_TRUE(e);
    const double first = e->pixels.values[0];
    EXPECT_GT(first, 0.01);
    EXPECT_NEAR(e->pixels.values[3], 9 * first, 1e-5 * first);  // a ninth of the weight
    EXPECT_TRUE(std::isnan(e->pixels.values[7]));
    EXPECT_NEAR(e->relmse, (first + 9 * first) / 2, 1e-5 * first);
}

// On average the estimate is the error, and 90 to 98 of 100 intervals hold it: normal noise, edges,
// and sparks.
TEST(error_estimate, is_the_error_of_known_noise) {
    const auto judge = [](Process& process, const char* name, double tolerance) {
        constexpr int seeds = 200;
        double estimated = 0;
        double found = 0;
        int held = 0;
        for (int i = 0; i < seeds; ++i) {
            const auto [e, error] = process.draw();
            ASSERT_TRUE(e);
            estimated += e->relmse;
            found += error;
            held += std::abs(e->relmse - error) <= e->margin();
        }
        EXPECT_NEAR(estimated / found, 1, tolerance) << name;
        EXPECT_GE(held, 0.9 * seeds) << name;
    };
    for (const uint samples : {4u, 16u}) {
        const bool few = samples == 4;
        Slope slope(samples);
        judge(slope, "slope", few ? 0.1 : 0.03);
        Edges edges(samples);
        judge(edges, "edges", few ? 0.15 : 0.1);
        Sparks sparks(samples);
        judge(sparks, "sparks", few ? 0.2 : 0.05);
    }
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
            for (const uint spp : {4u, 8u, 7u}) {
                if (spp == 7 && sampler == "power") continue;
                SCOPED_TRACE(fmt::format("{}, {} spp", sampler, spp));
                RenderOptions options;
                options.sampler = sampler;
                options.spp = spp;
                options.pixel_centre = true;
                options.aovs = {"error"};
                double estimated = 0;
                double found = 0;
                int held = 0;
                for (options.seed = 0; options.seed < 12; ++options.seed) {
                    const FrameResult result = test::render(device, scene, options);
                    ASSERT_TRUE(result.error);
                    EXPECT_EQ(result.spp, spp);
                    EXPECT_EQ(result.light_samples, 4u);
                    EXPECT_EQ(result.later_light_samples, spp > 4 ? 16u : 4u);
                    const double error =
                        compare_images(result.image, truth, "image", "truth").relmse;
                    held += std::abs(result.error->relmse - error) <= result.error->margin();
                    estimated += result.error->relmse;
                    found += error;
                }
                EXPECT_NEAR(estimated / found, 1, spp == 8 ? 0.1 : 0.2);
                if (spp != 7) {
                    EXPECT_GE(held, 8);
                }
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
        options.target_error = 0.0005;
        const FrameResult result = test::render(device, scene, options);
        ASSERT_TRUE(result.error);
        EXPECT_LE(result.error->most(), 0.0005);
        EXPECT_GT(result.error->relmse, 0.0001);
        EXPECT_GT(result.spp, 8);
        EXPECT_LT(result.spp, 1024);
        // An image of 64 x 40 has too few pixels to stop at 4 samples.
        options.target_error = 1e9;
        EXPECT_EQ(test::render(device, scene, options).spp, 8);
        options.target_error = 1e-12;
        options.spp = 6;
        EXPECT_EQ(test::render(device, scene, options).spp, 6);
    }
}

// A deadline that is over leaves one sample of every pixel, whatever the sampler, and no estimate.
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
        options.aovs = {"error"};
        const FrameResult estimated = test::render(device, scene, options);
        EXPECT_FALSE(estimated.error) << sampler;
        EXPECT_TRUE(std::isnan(estimated.aovs[0].second.values[0])) << sampler;
    }
}

// In each of 4 x 4 pixels, 3% are far brighter than the rest. An image that met them less often
// than it should has the smaller error: stopped at 4 samples by that alone, images are darker on
// average and vary far more than they were to.
TEST(error_estimate, does_not_stop_small_images_where_they_are_dark) {
    const test::TestScene scene = test::make_scene(
        [](GltfWriter& out) {
            Mesh floor;
            floor.add_quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0});
            out.add_mesh("floor", floor, out.add_diffuse(glm::vec3(0.05f)));
            Mesh dots;
            for (int i = 0; i < 16; ++i) {
                const glm::vec2 centre(-0.75f + 0.5f * static_cast<float>(i % 4),
                                       -0.75f + 0.5f * static_cast<float>(i / 4));
                dots.add_quad({centre.x - 0.043f, centre.y - 0.043f, 0.001f}, {0.086f, 0, 0},
                              {0, 0.086f, 0});
            }
            out.add_mesh("dots", dots, out.add_diffuse(glm::vec3(0.9f)));
            out.add_point({0.1f, 0.1f, 5}, glm::vec3(1000));
            out.add_camera("front", {0, 0, 4}, {0, 0, 0}, 0.49f, 1);
        },
        4, 4);
    const Device& device = test::devices().front();
    RenderOptions options;
    options.sampler = "exhaustive";
    options.spp = 4096;
    const double truth = mean_luminance(test::render(device, scene, options).image);
    options.spp = 1 << 20;
    options.target_error = 0.02;
    std::vector<double> found;
    for (options.seed = 1; options.seed <= 10; ++options.seed)
        found.push_back(mean_luminance(test::render(device, scene, options).image) / truth);
    const Mean mean = mean_of(found);
    EXPECT_LT(*mean.standard_error, 0.02);
    EXPECT_NEAR(mean.value, 1, 4 * *mean.standard_error);
}

}  // namespace manylight

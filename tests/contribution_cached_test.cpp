// SPDX-License-Identifier: MIT
// Sampler contribution-cached: its neighbours, and what they change.
#include <cmath>
#include <set>

#include "output/metrics.hpp"
#include "support.hpp"
#include "verify/sampler_checks.hpp"

namespace manylight {
namespace {

Image render(const Device& device, const test::TestScene& scene, std::string_view sampler,
             const ParameterValues& parameters, uint seed = 1) {
    RenderOptions options;
    options.sampler = sampler;
    options.parameters = parameters;
    options.light_samples = 4;
    options.spp = 4;
    options.seed = seed;
    options.pixel_centre = true;
    return test::render(device, scene, options).image;
}

}  // namespace

TEST(contribution_cached, agrees_with_the_reference) {
    const Sampler& cached = find_sampler("contribution-cached");
    FOR_EACH_DEVICE(device)
    for (const std::string& scene : test::scene_names()) {
        SCOPED_TRACE(scene);
        for (const Check& check : checks_of(cached).run(test::verifier(scene, device), cached))
            test::expect_pass(check);
    }
}

// Of one row it draws what contribution-defensive draws, and of several something else.
TEST(contribution_cached, one_row_is_the_clusters_own) {
    const test::TestScene& scene = test::scene_named("points");
    FOR_EACH_DEVICE(device) {
        const Image own = render(device, scene, "contribution-defensive", {});
        const Image one = render(device, scene, "contribution-cached", {{"rows", 1}});
        const Image four = render(device, scene, "contribution-cached", {{"rows", 4}});
        EXPECT_LT(compare_images(one, own, "one", "own").relmse, 1e-9);
        EXPECT_GT(compare_images(four, own, "four", "own").relmse, 1e-5);
    }
}

// Beside the borders of clusters, where the own representative tells least, its error is lower than
// contribution-defensive's, and more so than elsewhere.
TEST(contribution_cached, borders_of_clusters_show_less) {
    const test::TestScene& scene = test::scene_named("points");
    const Device& device = test::devices().front();
    RenderOptions options;
    options.sampler = "exhaustive";
    options.spp = 1;
    options.pixel_centre = true;
    const Image truth = test::render(device, scene, options).image;
    options.sampler = "contribution-defensive";
    options.light_samples = 1;
    options.aovs = {"cluster"};
    const FrameResult clustered = test::render(device, scene, options);
    const std::vector<float>& cluster = clustered.aovs.at(0).second.values;
    std::set<std::size_t> border;  // pixels
    for (std::size_t i = 0; i + 1 < truth.pixel_count(); ++i)
        if ((i + 1) % truth.width != 0 && cluster[i] != cluster[i + 1]) border.insert({i, i + 1});
    ASSERT_GT(border.size(), 200u);
    double errors[2][2] = {};  // [beside borders][cached] relative, summed
    for (const bool cached : {false, true})
        for (uint seed = 1; seed <= 30; ++seed) {
            const Image image = render(
                device, scene, cached ? "contribution-cached" : "contribution-defensive", {}, seed);
            for (std::size_t v = 0; v < truth.values.size(); ++v)
                errors[border.contains(v / 3)][cached] +=
                    std::abs(image.values[v] - truth.values[v]) / (truth.values[v] + 0.01);
        }
    const double beside = errors[1][1] / errors[1][0];
    EXPECT_LT(beside, 0.95);
    EXPECT_LT(beside, errors[0][1] / errors[0][0]);
}

}  // namespace manylight

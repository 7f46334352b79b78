// SPDX-License-Identifier: MIT
// What `manylight inspect` reports of a pixel, against images and against simulated draws.
#include "explain/inspect.hpp"

#include <cmath>
#include <random>

#include "pipeline/frame.hpp"
#include "reference/adaptive.hpp"
#include "reference/shading.hpp"
#include "support.hpp"

namespace manylight {
namespace {

// A scene that sampler adaptive has rendered.
struct Learned {
    const test::TestScene& scene;
    Tiles tiles;
    WideBvh bvh;
    Frame frame;

    static RenderOptions options(const test::TestScene& scene, uint spp, uint light_samples) {
        RenderOptions o;
        o.sampler = "adaptive";
        o.spp = spp;
        o.light_samples = light_samples;
        o.width = scene.width;
        o.height = scene.height;
        return o;
    }
    Learned(const test::TestScene& s, uint spp, uint light_samples)
        : scene(s),
          tiles(all_tiles(s.width, s.height, ADAPTIVE_TILE)),
          bvh(build_wide_bvh(s.scene, 8, 8, reach_of(s.scene, s.camera))),
          frame(test::devices().back(), s.scene, bvh, s.camera, options(s, spp, light_samples)) {
        frame.prepare();
        Progress quiet("", true);
        (void)frame.render(quiet);
    }
    [[nodiscard]] TileKnowledge knowledge(glm::uvec2 pixel) const {
        return dynamic_cast<Adaptive&>(frame.sampler())
            .knowledge(pixel.y / tiles.size * tiles.columns + pixel.x / tiles.size);
    }
    [[nodiscard]] PixelReport inspect(glm::uvec2 pixel) const {
        return inspect_pixel(scene.scene, frame.tree(), scene.camera, tiles, pixel,
                             knowledge(pixel));
    }
};

const std::vector<glm::uvec2> pixels = {{20, 30}, {45, 20}, {33, 33}, {5, 36}};

}  // namespace

// The truth adds up to the image of all lights, and every light is in one node.
TEST(inspect, contributions_sum_to_the_radiance_of_all_lights) {
    for (const std::string& name : test::scene_names()) {
        const test::TestScene& scene = test::scene_named(name);
        const Learned learned(scene, 1, 4);
        RenderOptions options;
        options.sampler = "exhaustive";
        options.hide_emitters = true;
        options.pixel_centre = true;
        // Areas are sampled at random, and by a fixed set of points in the report.
        const bool areas = name == "kinds";
        options.spp = areas ? 100 : 1;
        const Image image = test::render(test::devices().back(), scene, options).image;
        for (const glm::uvec2 pixel : pixels) {
            SCOPED_TRACE(fmt::format("{}, pixel {}, {}", name, pixel.x, pixel.y));
            const PixelReport report = learned.inspect(pixel);
            const float* expected = image.at(pixel.x, pixel.y);
            if (!report.hit()) {
                EXPECT_EQ(expected[0], 0);
                continue;
            }
            for (int c = 0; c < 3; ++c)
                EXPECT_NEAR(report.radiance[c], expected[c],
                            (areas ? 0.03 : 1e-3) * expected[c] + 1e-6);
            double sum = 0;
            std::size_t lights = 0;
            double noise = report.count_noise;
            for (const InspectedNode& node : report.nodes) {
                sum += node.contribution;
                lights += learned.frame.tree().nodes[node.node].count;
                noise += node.noise;
                EXPECT_EQ(node.contribution == 0, node.seen == 0);
                EXPECT_LE(node.seen, node.facing);
            }
            EXPECT_NEAR(sum, reference::luminance(report.radiance), 1e-9);
            EXPECT_EQ(lights, scene.scene.lights.size());
            EXPECT_NEAR(noise, report.variance > 0 ? 1 : 0, 1e-9);
        }
    }
}

TEST(inspect, expected_draws_sum_to_the_number_of_draws) {
    const test::TestScene& scene = test::scene_named("many");
    for (const uint light_samples : {1u, 4u, 20u}) {
        const Learned learned(scene, 1, light_samples);
        for (const glm::uvec2 pixel : pixels) {
            TileKnowledge knowledge = learned.knowledge(pixel);
            const double most = MOST_DRAWS * light_samples;
            EXPECT_GE(learned.inspect(pixel).draws(), FEWEST_DRAWS * light_samples * 0.999);
            EXPECT_LE(learned.inspect(pixel).draws(), most);
            knowledge.budget.factor = 0;  // all pixels alike
            const PixelReport report = inspect_pixel(scene.scene, learned.frame.tree(),
                                                     scene.camera, learned.tiles, pixel, knowledge);
            EXPECT_NEAR(report.draws(), light_samples, 1e-4 * light_samples);
            for (const InspectedNode& node : report.nodes)
                if (learned.frame.tree().nodes[node.node].count == 1) {
                    EXPECT_LE(node.draws, knowledge.rounds);
                }
        }
    }
}

// V^ is that of the pixel's own cell: high for the lights that it sees, low for those that it does
// not, where shadows' edges cross the tile.
TEST(inspect, visibility_is_learned_where_the_pixel_is) {
    const Learned learned(test::scene_named("points"), 32, 8);
    double sums[2] = {0, 0};
    double counts[2] = {0, 0};
    for (uint y = 2; y < 40; y += 7)
        for (uint x = 2; x < 64; x += 7)
            for (const InspectedNode& node : learned.inspect({x, y}).nodes)
                if (node.facing > 0) {
                    sums[node.seen] += node.visibility;
                    counts[node.seen] += 1;
                }
    EXPECT_GT(counts[0], 50);
    EXPECT_GT(sums[1] / counts[1], 0.85);
    EXPECT_LT(sums[0] / counts[0], 0.25);
}

// The variance against that of draws as the sampler makes them, one by one.
TEST(inspect, variance_is_that_of_simulated_draws) {
    for (const char* name : {"points", "kinds", "many"}) {
        const test::TestScene& scene = test::scene_named(name);
        const Learned learned(scene, 1, 4);
        const LightTree& tree = learned.frame.tree();
        const reference::Tracer tracer(scene.scene);
        for (const glm::uvec2 pixel : {pixels[0], pixels[1]}) {
            const PixelReport report = learned.inspect(pixel);
            ASSERT_TRUE(report.hit());
            const reference::Point point{scene.scene, scene.camera, report.surface};
            std::mt19937 random(7);
            std::uniform_real_distribution<double> uniform(0, 1);
            double sum = 0;
            double squares = 0;
            constexpr int count = 6000;
            for (int i = 0; i < count; ++i) {
                double value = 0;
                double reached = uniform(random);
                for (const InspectedNode& node : report.nodes) {
                    const double taken =
                        0.8 * node.visibility *
                        reference::luminance(reference::node_estimate(tree, node.node, point));
                    value += taken;
                    reached += node.draws;
                    for (; reached >= 1; reached -= 1) {
                        value -= taken / node.draws;
                        const reference::Descent d =
                            reference::descend(tree, node.node, point, uniform(random), random());
                        if (d.probability == 0) continue;
                        const reference::Unshadowed term = reference::unshadowed(
                            point.surface, point.material(), point.viewer, tree.lights[d.light],
                            {uniform(random), uniform(random)});
                        if (term.value != glm::dvec3(0) && !tracer.occluded(term.shadow))
                            value +=
                                reference::luminance(term.value) / (node.draws * d.probability);
                    }
                }
                sum += value;
                squares += value * value;
            }
            const double mean = sum / count;
            const double variance = squares / count - mean * mean;
            SCOPED_TRACE(fmt::format("{}, pixel {}, {}", name, pixel.x, pixel.y));
            EXPECT_NEAR(mean, reference::luminance(report.radiance),
                        5 * std::sqrt(report.variance / count) + 0.01 * mean);
            // A whole number of draws is one in a million short (find_scale() of the sampler).
            EXPECT_NEAR(variance, report.variance, 0.15 * report.variance + 1e-6 * mean * mean);
        }
    }
}

TEST(inspect, a_pixel_that_sees_nothing_has_no_nodes) {
    const Learned learned(test::scene_named("oriented"), 1, 4);
    // In a tile where others do see something.
    uint checked = 0;
    for (uint y = 0; y < 37; ++y)
        for (uint x = 0; x < 50; x += 7) {
            const PixelReport report = learned.inspect({x, y});
            if (report.hit() || learned.knowledge({x, y}).cut.empty()) continue;
            ++checked;
            EXPECT_TRUE(report.nodes.empty());
            EXPECT_EQ(report.cut_nodes, 0u);
            EXPECT_EQ(report.draws(), 0);
        }
    EXPECT_GT(checked, 10u);
}

}  // namespace manylight

// SPDX-License-Identifier: MIT
// What sampler stochastic-lightcuts rests on: its cuts, bounds and probabilities, by the reference;
// and that a kernel's cut of all lights draws each with certainty.
#include "reference/samplers/stochastic_lightcuts.hpp"

#include <cmath>
#include <glm/gtc/constants.hpp>
#include <random>

#include "output/metrics.hpp"
#include "shared/stochastic_lightcuts.h"
#include "support.hpp"

namespace manylight {
namespace {

constexpr double pi = glm::pi<double>();

// Surface points in and around a scene's finite lights, facing anywhere, white and Lambert's.
class Receivers {
  public:
    explicit Receivers(const LightTree& tree) {
        const LightNode& root = tree.nodes[tree.roots.back()];
        const glm::vec3 margin = 0.3f * glm::vec3(root.upper - root.lower) + 0.1f;
        lower_ = glm::vec3(root.lower) - margin;
        size_ = glm::vec3(root.upper) + margin - lower_;
    }

    Surface next() {
        std::uniform_real_distribution<float> unit(0, 1);
        std::normal_distribution<float> normal;
        Surface surface{};
        for (int axis = 0; axis < 3; ++axis)
            surface.position[axis] = lower_[axis] + size_[axis] * unit(engine_);
        const glm::vec3 n(normal(engine_), normal(engine_), normal(engine_));
        surface.normal = surface.horizon = float4(glm::normalize(n), 0);
        return surface;
    }

  private:
    std::mt19937 engine_{17};
    glm::vec3 lower_, size_;
};

// The illuminance by a light, or by a point of it, that nothing is in front of, lx.
double illuminance(const Light& light, const Surface& surface, const glm::dvec2& u) {
    Material white{};
    white.base_color = float4(1, 1, 1, 0);
    return pi *
           reference::luminance(reference::unshadowed(surface, white, Camera{}, light, u).value);
}

double distance_to(const LightNode& node, const Surface& surface) {
    const glm::vec3 p(surface.position);
    return glm::distance(p, glm::clamp(p, glm::vec3(node.lower), glm::vec3(node.upper)));
}

// Whether all of a node's lights shine as their cosine does, or everywhere alike.
bool has_spots(const LightTree& tree, const LightNode& node) {
    for (uint i = node.first; i < node.first + node.count; ++i)
        if (static_cast<LightKind>(tree.lights[i].position.w) == LIGHT_SPOT) return true;
    return false;
}

}  // namespace

// The nodes of a cut are apart and in order, and what none of them holds does not shine there.
TEST(stochastic_lightcuts, cuts_hold_what_shines_once) {
    for (const char* name : {"many", "kinds"}) {
        const LightTree tree = build_light_tree(test::scene_named(name).scene.lights);
        Receivers receivers(tree);
        std::size_t left_out = 0;
        for (int i = 0; i < 60; ++i) {
            const Surface surface = receivers.next();
            for (const uint size : {1u, 2u, 3u, 7u, 32u, 10'000u}) {
                const reference::LightCut cut = reference::light_cut(tree, surface, size);
                ASSERT_LE(cut.nodes.size(), size);
                std::vector<bool> held(tree.lights.size());
                uint end = 0;
                for (const uint n : cut.nodes) {
                    const bool all = n == BOTH_ROOTS;
                    const uint first = all ? 0 : tree.nodes[n].first;
                    ASSERT_GE(first, end);
                    end = all ? static_cast<uint>(held.size()) : first + tree.nodes[n].count;
                    std::fill(held.begin() + first, held.begin() + end, true);
                }
                for (std::size_t place = 0; place < held.size(); ++place) {
                    if (held[place]) continue;
                    ++left_out;
                    for (const double u : {0.1, 1. / 3, 0.8})
                        EXPECT_EQ(illuminance(tree.lights[place], surface, glm::dvec2(u)), 0);
                }
                // Room for all: only lights are left.
                for (const uint n : cut.nodes)
                    ASSERT_TRUE(size < tree.lights.size() || tree.nodes[n].count == 1);
            }
        }
        EXPECT_GT(left_out, 100u) << name;
    }
}

// No light shines more than the bounds of the nodes that hold it, and all of them together no more
// than a node's, wherever the distance is not cut off. (Spots' cosine stands for their cone.)
TEST(stochastic_lightcuts, bounds_are_conservative) {
    for (const char* name : {"many", "kinds", "oriented"}) {
        const LightTree tree = build_light_tree(test::scene_named(name).scene.lights);
        Receivers receivers(tree);
        int judged = 0;
        int telling = 0;  // where the bound is less than five times too large
        for (int i = 0; i < 60; ++i) {
            const Surface surface = receivers.next();
            for (const LightNode& node : tree.nodes) {
                const double radius = glm::length(glm::vec3(node.upper - node.lower)) / 2;
                const bool near = !NODE_IS_INFINITE(node) && distance_to(node, surface) < radius;
                double sum = 0;
                for (uint k = node.first; k < node.first + node.count; ++k)
                    sum += illuminance(tree.lights[k], surface, glm::dvec2(1. / 3));
                if (sum == 0) continue;
                const double bound = reference::illuminance_bound(node, surface);
                ASSERT_GT(bound, 0);
                if (near || has_spots(tree, node)) continue;
                ++judged;
                telling += sum > bound / 5 ? 1 : 0;
                ASSERT_LE(sum, bound * (1 + 1e-4)) << "lights from " << node.first << " on";
            }
        }
        EXPECT_GT(judged, 300) << name;
        EXPECT_GT(telling, judged / 4) << name;
    }
}

// One light sample's probabilities come to 1, less what dead branches lose, and to 0 for no light
// that shines.
TEST(stochastic_lightcuts, probabilities_of_one_light_sample) {
    for (const char* name : {"many", "kinds"}) {
        const test::TestScene& s = test::scene_named(name);
        const LightTree tree = build_light_tree(s.scene.lights);
        const reference::StochasticLightcuts sampler(tree, MOST_CUT_NODES);
        Receivers receivers(tree);
        double mean = 0;
        for (int i = 0; i < 40; ++i) {
            const Surface surface = receivers.next();
            double sum = 0;
            for (uint light = 0; light < s.scene.lights.size(); ++light) {
                const double p = *sampler.probability({s.scene, s.camera, surface}, 0, light);
                sum += p;
                if (illuminance(s.scene.lights[light], surface, glm::dvec2(1. / 3)) > 0) {
                    EXPECT_GT(p, 0);
                }
            }
            EXPECT_LE(sum, 1 + 1e-9);
            mean += sum / 40;
        }
        EXPECT_GT(mean, 0.5) << name;
    }
}

// As many light samples as points: each is a node of its own, drawn with certainty.
TEST(stochastic_lightcuts, few_points_are_exact) {
    const test::TestScene& scene = test::scene_named("points");
    ASSERT_LE(scene.scene.lights.size(), std::size_t{MOST_CUT_NODES});
    RenderOptions options;
    options.pixel_centre = true;
    options.spp = 1;
    FOR_EACH_DEVICE(device) {
        options.sampler = "exhaustive";
        const Image expected = test::render(device, scene, options).image;
        options.sampler = "stochastic-lightcuts";
        options.light_samples = MOST_CUT_NODES;
        const Image found = test::render(device, scene, options).image;
        EXPECT_LT(compare_images(found, expected, "found", "expected").relmse, 1e-9);
        options.light_samples = 4;
        const Image drawn = test::render(device, scene, options).image;
        EXPECT_GT(compare_images(drawn, expected, "drawn", "expected").relmse, 1e-4);
    }
}

}  // namespace manylight

// SPDX-License-Identifier: MIT
#include "light_tree/light_tree.hpp"

#include <cmath>
#include <random>
#include <set>

#include "reference/adaptive.hpp"
#include "reference/light_tree.hpp"
#include "reference/shading.hpp"
#include "support.hpp"

namespace manylight {
namespace {

Light point(glm::vec3 position, float intensity) {
    return {float4(position, LIGHT_POINT), float4(0), float4(0),
            float4(glm::vec3(intensity), 12.566f * intensity)};
}

LightKind kind_of(const Light& light) { return static_cast<LightKind>(light.position.w); }

glm::vec3 random_direction(std::mt19937& engine) {
    std::normal_distribution<float> normal;
    return glm::normalize(glm::vec3(normal(engine), normal(engine), normal(engine)));
}

// Points, oriented points, spots, triangles of one and two sides, and directional lights.
std::vector<Light> random_lights(int count, bool directional) {
    std::mt19937 engine(3);
    std::uniform_real_distribution<float> unit(0, 1);
    Scene scene;
    for (int i = 0; i < count; ++i) {
        const glm::vec3 p(10 * unit(engine), 3 * unit(engine), 10 * unit(engine));
        const glm::vec3 n = random_direction(engine);
        const glm::vec3 color(unit(engine), unit(engine), unit(engine));
        switch (i % (directional ? 6 : 5)) {
            case 0:
                scene.lights.push_back(point(p, 1 + unit(engine)));
                break;
            case 1:
                scene.lights.push_back(
                    {float4(p, LIGHT_ORIENTED), float4(n, 0), float4(0), float4(color, 0)});
                break;
            case 2:
                scene.lights.push_back({float4(p, LIGHT_SPOT), float4(n, 0),
                                        float4(2.5f, 0.4f, 0, 0), float4(color, 0)});
                break;
            case 3:
            case 4:
                scene.lights.push_back(
                    {float4(p, i % 2 ? LIGHT_QUAD : LIGHT_TRIANGLE), float4(0.3f * n, i % 5 == 3),
                     float4(0.2f * random_direction(engine), 1e-5f), float4(color, 0)});
                break;
            default:
                scene.lights.push_back({float4(0, 0, 0, LIGHT_DIRECTIONAL), float4(n, 0), float4(0),
                                        float4(color, 0)});
        }
    }
    add_emitters(scene, 0);  // sets the powers
    return scene.lights;
}

}  // namespace

// Every node's children split its lights, every light is a leaf once, sums are sums.
TEST(light_tree, nodes_hold_their_lights) {
    const std::vector<Light> lights = random_lights(1000, true);
    const LightTree tree = build_light_tree(lights);
    EXPECT_EQ(std::set<uint>(tree.order.begin(), tree.order.end()).size(), lights.size());
    ASSERT_EQ(tree.roots.size(), 2u);
    std::size_t leaves = 0;
    for (std::size_t i = 0; i < tree.nodes.size(); ++i) {
        const LightNode& node = tree.nodes[i];
        leaves += node.count == 1;
        if (node.count > 1) {
            const LightNode& left = tree.nodes[i + 1];
            const LightNode& right = tree.nodes[i + 2 * left.count];
            EXPECT_EQ(left.first, node.first);
            EXPECT_EQ(right.first, node.first + left.count);
            EXPECT_EQ(left.count + right.count, node.count);
        }
        glm::dvec3 sum(0);
        glm::dvec3 centre(0);
        double phi = 0;
        double power = 0;
        double square = 0;
        const auto place_of = [&](const Light& l) {
            if (NODE_IS_INFINITE(node)) return -glm::dvec3(l.axis);
            glm::dvec3 p(l.position);
            if (kind_of(l) == LIGHT_TRIANGLE) p += glm::dvec3(l.axis + l.edge) / 3.0;
            if (kind_of(l) == LIGHT_QUAD) p += glm::dvec3(l.axis + l.edge) / 2.0;
            return p;
        };
        const auto intensity_of = [](const Light& l) {
            glm::dvec3 intensity(l.emission);
            const double area = glm::length(glm::cross(glm::dvec3(l.axis), glm::dvec3(l.edge)));
            if (kind_of(l) == LIGHT_TRIANGLE) intensity *= area / 2;
            if (kind_of(l) == LIGHT_QUAD) intensity *= area;
            return intensity;
        };
        for (uint k = node.first; k < node.first + node.count; ++k) {
            const Light& l = tree.lights[k];
            EXPECT_EQ(l.position, lights[tree.order[k]].position);
            EXPECT_EQ((kind_of(l) == LIGHT_DIRECTIONAL), NODE_IS_INFINITE(node));
            sum += intensity_of(l);
            centre += reference::luminance(intensity_of(l)) * place_of(l);
            phi += reference::luminance(intensity_of(l));
            power += l.emission.w;
            EXPECT_LE(glm::length(place_of(l) - glm::dvec3(node.centre)), node.intensity.w + 1e-4);
            for (int axis = 0; axis < 3; ++axis) {
                EXPECT_GE(place_of(l)[axis], node.lower[axis] - 1e-5);
                EXPECT_LE(place_of(l)[axis], node.upper[axis] + 1e-5);
            }
        }
        centre /= phi;
        for (uint k = node.first; k < node.first + node.count; ++k) {
            const Light& l = tree.lights[k];
            const glm::dvec3 apart = place_of(l) - centre;
            double inner = 0;
            // Over a triangle from its corners, over a parallelogram from its sides.
            if (kind_of(l) == LIGHT_TRIANGLE)
                for (const glm::dvec3 corner :
                     {glm::dvec3(l.position), glm::dvec3(l.position + l.axis),
                      glm::dvec3(l.position + l.edge)})
                    inner += glm::dot(corner - place_of(l), corner - place_of(l)) / 12;
            if (kind_of(l) == LIGHT_QUAD)
                for (const glm::dvec3 side : {glm::dvec3(l.axis), glm::dvec3(l.edge)})
                    inner += glm::dot(side, side) / 12;
            square += reference::luminance(intensity_of(l)) * (glm::dot(apart, apart) + inner);
        }
        EXPECT_LE(glm::length(sum - glm::dvec3(node.intensity)), 1e-4 * glm::length(sum));
        EXPECT_NEAR(power, node.cone.w, 1e-4 * power);
        EXPECT_LE(glm::length(centre - glm::dvec3(node.centre)), 1e-3);
        EXPECT_NEAR(square / phi, node.centre.w, 1e-4 + 1e-3 * square / phi);
    }
    EXPECT_EQ(leaves, lights.size());
}

// No light contributes more than a node's importance allows, wherever the receiver is; so a light
// that can contribute has a positive probability.
TEST(light_tree, importance_is_conservative) {
    const std::vector<Light> lights = random_lights(400, true);
    const LightTree tree = build_light_tree(lights);
    std::mt19937 engine(5);
    std::uniform_real_distribution<float> unit(0, 1);
    Material white{};
    white.base_color = float4(1, 1, 1, 0);
    int reached = 0;
    for (int i = 0; i < 60; ++i) {
        Surface surface{};
        surface.position =
            float4(14 * unit(engine) - 2, 5 * unit(engine) - 1, 14 * unit(engine) - 2, 1);
        surface.normal = surface.horizon = float4(random_direction(engine), 0);
        for (const LightNode& node : tree.nodes) {
            bool contributes = false;
            for (uint k = node.first; k < node.first + node.count && !contributes; ++k)
                contributes = reference::unshadowed(surface, white, Camera{}, tree.lights[k],
                                                    glm::dvec2(1. / 3))
                                  .value != glm::dvec3(0);
            if (!contributes) continue;
            ++reached;
            ASSERT_GT(reference::importance(node, surface), 0)
                << "lights " << node.first << " to " << node.first + node.count;
        }
    }
    EXPECT_GT(reached, 1000);
}

// Spots, 32 at a place: where any of a node's lights shines, so does its estimate;
// and where none does, most estimates of groups say so.
TEST(light_tree, spots_shine_within_reach) {
    std::mt19937 engine(7);
    std::uniform_real_distribution<float> unit(0, 1);
    Scene scene;
    for (int i = 0; i < 256; ++i) {
        scene.lights.push_back({float4(static_cast<float>(i / 32), 2, 0, LIGHT_SPOT),
                                float4(random_direction(engine), 0), float4(30, 1 / 30.f, 0, 0),
                                float4(1, 1, 1, 0)});
    }
    Material white{};
    white.base_color = float4(1, 1, 1, 0);
    white.roughness = 1;
    scene.materials = {white};
    add_emitters(scene, 0);
    const LightTree tree = build_light_tree(scene.lights);
    int reached = 0;
    int dark = 0;
    int found_dark = 0;
    for (int i = 0; i < 200; ++i) {
        Surface surface{};
        surface.position = float4(8 * unit(engine), 4 * unit(engine), 2 * unit(engine), 1);
        surface.normal = surface.horizon = float4(random_direction(engine), 0);
        for (uint n = 0; n < tree.nodes.size(); ++n) {
            const LightNode& node = tree.nodes[n];
            bool contributes = false;
            for (uint k = node.first; k < node.first + node.count && !contributes; ++k)
                contributes = reference::unshadowed(surface, white, Camera{}, tree.lights[k],
                                                    glm::dvec2(1. / 3))
                                  .value != glm::dvec3(0);
            const double estimate =
                reference::luminance(reference::node_estimate(tree, n, {scene, Camera{}, surface}));
            if (contributes) {
                ++reached;
                ASSERT_GT(estimate, 0) << "lights " << node.first << ", " << node.count;
            } else if (node.count > 1 && node.count <= 4) {
                ++dark;
                found_dark += estimate == 0;
            }
        }
    }
    EXPECT_GT(reached, 1000);
    EXPECT_GT(found_dark, 0.9 * dark);
}

// Narrow beams at one place, and points that each reaches: no node that holds its light is thought
// not to.
TEST(light_tree, narrow_beams_are_not_missed) {
    std::mt19937 engine(9);
    std::uniform_real_distribution<float> unit(0, 1);
    for (const double angle : {2e-4, 1e-3, 0.02}) {
        Scene scene;
        for (int i = 0; i < 64; ++i)
            scene.lights.push_back({float4(0, 2, 0, LIGHT_SPOT),
                                    float4(random_direction(engine), 0),
                                    float4(spot_cone(angle, angle), 0, 0), float4(1, 1, 1, 0)});
        add_emitters(scene, 0);
        const LightTree tree = build_light_tree(scene.lights);
        for (std::size_t place = 0; place < tree.lights.size(); ++place) {
            const glm::dvec3 axis(tree.lights[place].axis);
            const glm::dvec3 side = glm::normalize(glm::cross(axis, glm::dvec3(1, 2, 3)));
            for (int k = 0; k < 20; ++k) {
                const double off = 0.99 * angle * unit(engine);
                const glm::dvec3 towards = std::cos(off) * axis + std::sin(off) * side;
                Surface surface{};
                surface.position =
                    float4(glm::vec3(glm::dvec3(0, 2, 0) + (1.0 + unit(engine)) * towards), 1);
                surface.normal = surface.horizon = float4(glm::vec3(-towards), 0);
                for (const LightNode& node : tree.nodes)
                    if (node.first <= place && place < node.first + node.count) {
                        ASSERT_GT(reference::importance(node, surface), 0) << angle;
                    }
            }
        }
    }
}

// Coincident lights, one light, none; sums that overflow nothing.
TEST(light_tree, degenerate_sets) {
    EXPECT_TRUE(build_light_tree({}).roots.empty());
    EXPECT_EQ(build_light_tree({point({1, 2, 3}, 5)}).nodes.size(), 1u);
    const std::vector<Light> same(3000, point({1, 2, 3}, 5));
    const LightTree tree = build_light_tree(same);
    EXPECT_EQ(tree.nodes.size(), 2 * same.size() - 1);
    EXPECT_EQ(tree.nodes[0].centre, float4(1, 2, 3, 0));
    EXPECT_NEAR(tree.nodes[0].intensity.r, 15000, 1);
    const std::vector<Light> dark(10, point({1, 2, 3}, 0));
    EXPECT_EQ(build_light_tree(dark).nodes.size(), 19u);
}

// Lights that are seen are the left side of a root, whatever their places are.
TEST(light_tree, seen_lights_are_apart) {
    std::vector<Light> lights;
    std::vector<bool> seen;
    for (int i = 0; i < 100; ++i) {
        lights.push_back(point({0.1f * static_cast<float>(i), 1, 0}, 1 + static_cast<float>(i)));
        seen.push_back(i % 7 == 3);
    }
    const auto count = static_cast<uint>(std::ranges::count(seen, true));
    const LightTree tree = build_light_tree(lights, seen);
    EXPECT_EQ(tree.nodes[1].count, count);
    for (std::size_t place = 0; place < lights.size(); ++place)
        EXPECT_EQ(seen[tree.order[place]], place < count) << place;
    const LightTree usual = build_light_tree(lights);
    for (const bool all : {false, true})
        EXPECT_EQ(build_light_tree(lights, std::vector<bool>(lights.size(), all)).order,
                  usual.order);
}

}  // namespace manylight

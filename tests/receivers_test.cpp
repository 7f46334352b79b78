// SPDX-License-Identifier: MIT
// Points that are no pixels, and lights that are not the scene's.
#include <gtest/gtest.h>

#include <glm/gtc/constants.hpp>
#include <random>

#include "reference/gbuffer.hpp"
#include "reference/samples.hpp"
#include "samplers/table.hpp"
#include "support.hpp"

namespace manylight {
namespace {

constexpr int draws = 96;
constexpr uint light_samples = 4;

struct Receivers {
    std::vector<Surface> surfaces;   // [item]
    std::vector<Outgoing> outgoing;  // [item]
};

// Points of surfaces that rays of random origins and directions meet; their light goes back along
// these rays.
Receivers random_receivers(const Scene& scene, const reference::Tracer& tracer, std::size_t count) {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> unit(0, 1);
    Receivers out;
    while (out.surfaces.size() < count) {
        reference::Ray ray;
        ray.origin = {4 * unit(random) - 2, 3 * unit(random), 4 * unit(random) - 2};
        const double z = 2 * unit(random) - 1;
        const double phi = 2 * glm::pi<double>() * unit(random);
        const double radius = std::sqrt(1 - z * z);
        ray.direction = {radius * std::cos(phi), radius * std::sin(phi), z};
        const auto hit = tracer.closest_hit(ray);
        if (!hit) continue;
        out.surfaces.push_back(reference::surface_at(scene, ray, hit));
        out.outgoing.push_back({float4(glm::vec3(-ray.direction), 0),
                                float4(unit(random), 2 * unit(random), 0.5 + unit(random), 0)});
    }
    return out;
}

std::vector<Light> other_lights() {
    std::mt19937 random(9);
    std::uniform_real_distribution<float> unit(0, 1);
    std::vector<Light> lights(60, Light{});
    for (Light& light : lights) {
        light.position = {4 * unit(random) - 2, 3 * unit(random), 4 * unit(random) - 2,
                          static_cast<float>(LIGHT_POINT)};
        const glm::vec3 color(0.2f + unit(random), 0.2f + unit(random), 0.2f + unit(random));
        light.emission = float4(color, 4 * glm::pi<float>() * luminance(color));
    }
    return lights;
}

struct Sums {
    glm::dvec3 mean{0}, square{0};
};

// [item] of all draws of a sampler's.
std::vector<Sums> draw_often(Device& device, const Sampler& row, DeviceScene scene,
                             const std::vector<Light>& lights, Receivers receivers) {
    const unsigned size = row.tile_size > 0 ? row.tile_size : 16;
    const Tiles tiles = all_tiles(size, size, size);
    const std::size_t items = item_count(tiles);
    const std::size_t used = receivers.surfaces.size();
    Surface missed{};
    missed.position.w = -1;
    receivers.surfaces.resize(items, missed);
    receivers.outgoing.resize(items);
    set_outgoing(scene, device.upload(receivers.outgoing));
    const Buffer<Surface> surfaces = device.upload(receivers.surfaces);
    ClusterOptions clusters;
    clusters.tile_size = size;
    const std::unique_ptr<LightSampler> sampler =
        row.make({device, scene, lights, 1, size, size, light_samples, clusters, values_of(row)});
    sampler->prepare();
    sampler->begin(tiles, surfaces, 3, [](std::size_t) {});
    Estimates estimates{device.upload(std::vector<float4>(items, float4(0))),
                        device.upload(std::vector<float4>(items, float4(0)))};
    const int times = row.all_lights ? 1 : draws;
    std::vector<Sums> out(used);
    for (uint i = 0; i < static_cast<uint>(times); ++i) {
        sampler->draw(tiles, {i, 3, false},
                      row.all_lights ? static_cast<uint>(lights.size()) : light_samples, surfaces,
                      estimates, [](const auto&, std::size_t) { return true; });
        const std::vector<float4> found = estimates.sums.download(0, used);
        for (std::size_t item = 0; item < used; ++item) {
            const glm::dvec3 value(found[item]);
            out[item].mean += value / static_cast<double>(times);
            out[item].square += value * value / static_cast<double>(times);
        }
    }
    return out;
}

}  // namespace

// Random points, directions, throughputs and lights: every sampler against the sum over all lights.
TEST(receivers, are_lit_by_lights_of_any_set) {
    const test::TestScene& s = test::scene_named("kinds");
    const reference::Tracer tracer(s.scene);
    const Receivers receivers = random_receivers(s.scene, tracer, 250);
    const std::vector<Light> lights = other_lights();
    std::vector<glm::dvec3> exact(receivers.surfaces.size(), glm::dvec3(0));
    for (std::size_t item = 0; item < exact.size(); ++item) {
        const Surface& surface = receivers.surfaces[item];
        const Outgoing& outgoing = receivers.outgoing[item];
        const Camera parallel{float4(0), float4(0), float4(0),
                              float4(-glm::vec3(outgoing.direction), 1)};
        for (const Light& light : lights) {
            const reference::Unshadowed term = reference::unshadowed(
                surface, s.scene.materials[surface.shading], parallel, light, glm::dvec2(0.5));
            if (term.value != glm::dvec3(0) && !tracer.occluded(term.shadow))
                exact[item] += term.value * glm::dvec3(outgoing.throughput);
        }
    }
    const LightTree tree = build_light_tree(lights);
    FOR_EACH_DEVICE(each) {
        Device device = each;
        const DeviceForm form = device.form();
        const WideBvh bvh =
            build_wide_bvh(s.scene, form.bvh_width, form.bvh_width, reach_of(s.scene, s.camera));
        const DeviceScene scene = upload_scene(device, s.scene, bvh, s.camera);
        for (const Sampler& row : all_samplers()) {
            if (row.biased) continue;
            SCOPED_TRACE(std::string(row.name));
            const std::vector<Sums> found = draw_often(
                device, row, with_lights(device, scene, lights, row.tree ? &tree : nullptr), lights,
                receivers);
            // Of two halves of the points apart, by channel.
            for (const std::size_t half : {0, 1}) {
                glm::dvec3 difference(0), variance(0), sum(0);
                for (std::size_t item = half; item < exact.size(); item += 2) {
                    const Sums& f = found[item];
                    sum += exact[item];
                    difference += f.mean - exact[item];
                    variance += (f.square - f.mean * f.mean) / double{draws};
                }
                for (int c = 0; c < 3; ++c) {
                    ASSERT_GT(sum[c], 1);
                    EXPECT_LT(std::abs(difference[c]), 4.5 * std::sqrt(variance[c]) + 1e-4 * sum[c])
                        << "half " << half << ", channel " << c << ": of " << sum[c];
                }
            }
        }
    }
}

}  // namespace manylight

// SPDX-License-Identifier: MIT
#include "stages/samples.hpp"

#include <cmath>

#include "reference/contributions.hpp"
#include "reference/pdf.hpp"
#include "reference/tiles.hpp"
#include "support.hpp"
#include "verify/sampler_checks.hpp"

namespace manylight {
namespace {

constexpr unsigned size = 16;
constexpr uint draws = 1500;

// A colour of luminance about 1 whose red and green tell i.
glm::vec3 hue(int i) {
    return {0.3f + 0.4f * static_cast<float>(i % 4), 0.6f + 0.4f * static_cast<float>(i / 4), 1};
}

// A plane under twelve lights of different hues, each of which every pixel sees: the hue of one
// light sample's estimate tells which light was drawn.
const test::TestScene& open_scene() {
    static const test::TestScene scene = test::make_scene(
        [](GltfWriter& out) {
            Mesh plane;
            plane.add_quad({-5, 0, 5}, {10, 0, 0}, {0, 0, -10});
            out.add_mesh("plane", plane, out.add_diffuse(glm::vec3(0.5f)));
            for (int i = 0; i < 12; ++i)
                out.add_point(
                    {0.7f * static_cast<float>(i) - 4, 1 + 0.13f * static_cast<float>(i % 5), 0},
                    (1 + 0.7f * static_cast<float>(i * i % 7)) * hue(i));
            out.add_camera("front", {0, 3, 4}, {0, 0, 0}, 0.8f, 1);
        },
        size, size);
    return scene;
}

struct Drawn {
    std::vector<Surface> surfaces;
    std::vector<std::vector<float4>> values;  // [draw][item]
    std::vector<double> expected;             // [item * lights + light] probability
};

// Draws one light sample per pixel, many times, with the probabilities that the reference gives;
// none where it has no closed form.
Drawn draw_often(Device device, const Sampler& sampler) {
    const test::TestScene& s = open_scene();
    const auto lights = static_cast<uint>(s.scene.lights.size());
    const Tiles tiles = all_tiles(size, size, 16);
    const WideBvh bvh = build_wide_bvh(s.scene, 8, 8, 10);
    const LightTree tree = build_light_tree(s.scene.lights);
    const DeviceScene uploaded =
        upload_scene(device, s.scene, bvh, s.camera, sampler.tree ? &tree : nullptr);
    Drawn out;
    Buffer<Surface> surfaces = device.allocate<Surface>(item_count(tiles));
    GBufferStage(device, uploaded).trace(tiles, {}, surfaces);
    out.surfaces = surfaces.download();

    ClusterOptions clusters;
    clusters.tile_size = 16;
    const std::unique_ptr<LightSampler> drawing = sampler.make(
        {device, uploaded, s.scene.lights, tiles.count, 16, size, 1, clusters, values_of(sampler)});
    drawing->prepare();
    drawing->begin(tiles, surfaces, 11, [](std::size_t) {});
    const std::unique_ptr<reference::Sampler> judge =
        checks_of(sampler).reference(*drawing, {s.scene, tree});
    const auto* probability = dynamic_cast<const reference::OneLight*>(judge.get());
    if (probability == nullptr) return out;
    for (std::size_t item = 0; item < item_count(tiles); ++item)
        for (uint y = 0; y < lights; ++y) {
            const std::optional<double> expected =
                probability->probability({s.scene, s.camera, out.surfaces[item]}, item, y);
            if (!expected) return out;
            out.expected.push_back(out.surfaces[item].position.w < 0 ? 0 : *expected);
        }
    Estimates estimates{device.allocate<float4>(item_count(tiles)),
                        device.allocate<float4>(item_count(tiles))};
    for (uint i = 0; i < draws; ++i) {
        drawing->draw(tiles, {i, 11, false}, 1, surfaces, estimates,
                      [](const auto&, std::size_t) { return true; });
        out.values.push_back(estimates.sums.download());
    }
    return out;
}

// The light whose hue an estimate has.
std::size_t light_of(const float4& value) {
    const auto red = std::lround((value.r / value.b - 0.3f) / 0.4f);
    const auto green = std::lround((value.g / value.b - 0.6f) / 0.4f);
    return static_cast<std::size_t>(red + 4 * green);
}

// How often each light was drawn at an item. An estimate is C / p of the light drawn, which is
// checked.
std::vector<int> count_lights(const Drawn& drawn, std::size_t item) {
    const test::TestScene& s = open_scene();
    const std::size_t lights = s.scene.lights.size();
    const Surface& surface = drawn.surfaces[item];
    std::vector<int> counts(lights, 0);
    for (const std::vector<float4>& values : drawn.values) {
        const float4& value = values[item];
        const std::size_t light = light_of(value);
        if (light >= lights) {
            ADD_FAILURE() << "no light has this hue";
            return counts;
        }
        const double expected =
            reference::unshadowed(surface, s.scene.materials[surface.material], s.camera,
                                  s.scene.lights[light], glm::dvec2(0))
                .value.b /
            drawn.expected[item * lights + light];
        EXPECT_NEAR(value.b, expected, 1e-4 * expected);
        ++counts[light];
    }
    return counts;
}

}  // namespace

TEST(samples, agree_with_the_reference) {
    FOR_EACH_DEVICE(device)
    for (const std::string& scene : test::scene_names())
        for (const Sampler& sampler : all_samplers()) {
            if (checks_of(sampler).reference == nullptr) continue;
            SCOPED_TRACE(scene);
            test::expect_pass(check_estimates(test::verifier(scene, device), sampler));
        }
}

// Chi-squared of each sampler's frequencies against its probabilities, pixel by pixel.
TEST(samples, frequencies_follow_the_pdf) {
    FOR_EACH_DEVICE(device)
    for (const Sampler& sampler : all_samplers()) {
        if (checks_of(sampler).reference == nullptr) continue;
        SCOPED_TRACE(std::string(sampler.name));
        const Drawn drawn = draw_often(device, sampler);
        // The row says whether there is a closed form; without, samples are judged as estimates.
        EXPECT_EQ(drawn.values.empty(), sampler.closed_form.empty());
        if (drawn.values.empty()) continue;
        const std::size_t lights = open_scene().scene.lights.size();
        double all = 0;
        double freedom = 0;
        int pixels = 0;
        for (std::size_t item = 0; item < drawn.surfaces.size(); item += 5) {
            if (drawn.surfaces[item].position.w < 0) continue;
            const std::vector<int> counts = count_lights(drawn, item);
            double x = 0;
            double k = -1;
            for (std::size_t y = 0; y < lights; ++y) {
                const double expected = draws * drawn.expected[item * lights + y];
                if (expected < 5) continue;
                x += std::pow(counts[y] - expected, 2) / expected;
                ++k;
            }
            EXPECT_GT(test::chi_squared_tail(x, k), 1e-6) << "item " << item;
            all += x;
            freedom += k;
            ++pixels;
        }
        EXPECT_GT(pixels, 30);
        EXPECT_GT(test::chi_squared_tail(all, freedom), 1e-4);
    }
}

// A CDF of widths 1, 0, 2: each boundary belongs to the light that begins there.
TEST(samples, boundaries_of_a_small_cdf) {
    const test::TestScene& s = open_scene();
    std::vector<uint> cdf(s.scene.lights.size(), 3);
    cdf[0] = cdf[1] = 1;
    const Tiles tiles = all_tiles(size, size, 16);
    for (Device device : test::devices()) {
        const WideBvh bvh = build_wide_bvh(s.scene, 8, 8, 10);
        const DeviceScene uploaded = upload_scene(device, s.scene, bvh, s.camera);
        Buffer<Surface> surfaces = device.allocate<Surface>(item_count(tiles));
        GBufferStage(device, uploaded).trace(tiles, {}, surfaces);
        Estimates estimates{device.allocate<float4>(item_count(tiles)),
                            device.allocate<float4>(item_count(tiles))};
        SampleStage stage(device, uploaded, "samplers/power/power.cl", item_count(tiles));
        std::map<std::size_t, int> counts;
        for (uint i = 0; i < 40; ++i) {
            stage.draw(tiles, {i, 3, false}, 1, surfaces,
                       Arguments().set("power_cdf", device.upload(cdf)), estimates,
                       [](std::size_t) { return true; });
            for (const float4& e : estimates.sums.download())
                if (e.b > 0) ++counts[light_of(e)];
        }
        const double all = counts[0] + counts[2];
        EXPECT_EQ(counts.size(), 2u);
        EXPECT_GT(all, 5000);
        EXPECT_NEAR(counts[0] / all, 1. / 3, 5 * std::sqrt(2. / 9 / all));
    }
}

}  // namespace manylight

// SPDX-License-Identifier: MIT
#include <bit>

#include "reference/pdf.hpp"
#include "samplers/contribution/contribution.hpp"
#include "support.hpp"
#include "verify/sampler_checks.hpp"

namespace manylight {
namespace {

// The CDF of one row of contributions and powers.
std::vector<uint> cdf_of(Device device, const std::vector<float>& row,
                         const std::vector<float>& powers, Mixture mixture) {
    Scene scene;
    RowSum total{};
    for (std::size_t y = 0; y < row.size(); ++y) {
        scene.lights.push_back(
            {float4(0, 0, 0, LIGHT_POINT), float4(0), float4(0), float4(1, 1, 1, powers[y])});
        total.visible += std::max(row[y], 0.f);
        total.unshadowed += std::abs(row[y]);
        mixture.total_power += powers[y];
    }
    const WideBvh bvh = build_wide_bvh(scene, 4, 4, 1);
    const DeviceScene uploaded = upload_scene(device, scene, bvh, Camera{});
    const auto lights = static_cast<uint>(row.size());
    Matrix matrix(device, 1, lights);
    std::vector<uint> words;
    for (const float value : row) words.push_back(std::bit_cast<uint>(value));
    matrix.values.upload(words);
    matrix.totals.upload(std::vector<RowSum>{total});
    PdfStage(device, uploaded).normalise(1, mixture, matrix);
    return matrix.values.download();
}

}  // namespace

TEST(pdf, agrees_with_the_reference) {
    FOR_EACH_DEVICE(device)
    for (const std::string& scene : test::scene_names()) {
        SCOPED_TRACE(scene);
        Verifier& verifier = test::verifier(scene, device);
        test::expect_pass(check_pdf(verifier, "power", {.power = 1}, false));
        test::expect_pass(check_pdf(verifier, "contribution", paper_shares, true));
        test::expect_pass(check_pdf(verifier, "contribution-defensive", defensive_shares, true));
    }
}

// What samplers draw from is mixed as their pages say.
TEST(pdf, samplers_have_their_own_shares) {
    const test::TestScene& s = test::scene_named("points");
    const Tiles tiles = all_tiles(32, 32, 16);
    ClusterOptions options;
    options.tile_size = 16;
    FOR_EACH_DEVICE(each) {
        Device device = each;
        const WideBvh bvh = build_wide_bvh(s.scene, 8, 8, 10);
        const DeviceScene uploaded = upload_scene(device, s.scene, bvh, s.camera);
        Buffer<Surface> surfaces = device.allocate<Surface>(item_count(tiles));
        GBufferStage(device, uploaded).trace(tiles, {}, surfaces);
        const auto tables = [&](const char* name) {
            const std::unique_ptr<LightSampler> sampler =
                find_sampler(name).make({device, uploaded, s.scene.lights, tiles.count, 16, 32, 1,
                                         options, values_of(find_sampler(name))});
            sampler->prepare();
            sampler->begin(tiles, surfaces, 1, [](std::size_t) {});
            return tables_of(*sampler);
        };
        const auto expect_clustered = [&](const char* name, const Shares& shares, bool weighed) {
            options.shadow.weighed = weighed;
            Clustering clustering(device, uploaded, options, tiles.count);
            clustering.build(tiles, surfaces, [](std::size_t) {});
            const std::vector<float> matrix = clustering.matrix().values.as<float>().download();
            const Arguments found = tables(name);
            EXPECT_EQ(found.download<uint>("item_rows"), clustering.item_rows()) << name;
            const std::vector<uint> cdf = found.download<uint>("cdf");
            const std::size_t lights = s.scene.lights.size();
            for (std::size_t row = 0; row < clustering.regions().size(); ++row) {
                const std::vector<double> expected = reference::probabilities(
                    std::span(matrix).subspan(row * lights, lights), clustering.totals()[row],
                    s.scene.lights, mixture_of(shares, s.scene.lights));
                for (std::size_t y = 0; y < lights; ++y) {
                    const uint before = y > 0 ? cdf[row * lights + y - 1] : 0;
                    EXPECT_NEAR((cdf[row * lights + y] - before) / double{CDF_SCALE}, expected[y],
                                1e-6)
                        << name;
                }
            }
        };
        expect_clustered("contribution", {.visible = 1}, false);
        expect_clustered("contribution-defensive",
                         {.visible = 0.4f, .unshadowed = 0.5f, .power = 0.1f}, true);
        double power = 0;
        for (const Light& light : s.scene.lights) power += double{light.emission.w};
        for (const char* name : {"power", "ris"}) {
            uint before = 0;
            const std::vector<uint> cdf = tables(name).download<uint>("power_cdf");
            for (std::size_t y = 0; y < s.scene.lights.size(); ++y) {
                EXPECT_NEAR((cdf[y] - before) / double{CDF_SCALE},
                            s.scene.lights[y].emission.w / power, 1e-6)
                    << name;
                before = cdf[y];
            }
        }
    }
}

TEST(pdf, paper_weights_visible_lights_only) {
    FOR_EACH_DEVICE(device) {
        const std::vector<uint> cdf = cdf_of(device, {1, -5, 3, 0}, {1, 1, 1, 1}, {1, 0, 0, 0});
        const double unit = CDF_SCALE;
        EXPECT_NEAR(cdf[0] / unit, 0.25, 1e-6);
        EXPECT_EQ(cdf[1], cdf[0]);
        EXPECT_NEAR(cdf[2] / unit, 1, 1e-6);
        EXPECT_EQ(cdf[3], cdf[2]);
    }
}

// 0.4 C + 0.5 C without visibility + 0.1 power; where nothing is visible the rest is scaled up.
TEST(pdf, mixture_by_hand) {
    FOR_EACH_DEVICE(device) {
        const double unit = CDF_SCALE;
        std::vector<uint> cdf = cdf_of(device, {1, -3}, {6, 2}, {0.4f, 0.5f, 0.1f, 0});
        EXPECT_NEAR(cdf[0] / unit, 0.4 * 1 + 0.5 * 0.25 + 0.1 * 0.75, 1e-6);
        EXPECT_NEAR(cdf[1] / unit, 1, 1e-6);
        cdf = cdf_of(device, {-1, -3}, {6, 2}, {0.4f, 0.5f, 0.1f, 0});
        EXPECT_NEAR(cdf[0] / unit, (0.5 * 0.25 + 0.1 * 0.75) / 0.6, 1e-6);
    }
}

TEST(pdf, row_without_chances_is_zero) {
    FOR_EACH_DEVICE(device)
    for (const uint sum : cdf_of(device, {-1, 0, -2}, {1, 1, 1}, {1, 0, 0, 0})) EXPECT_EQ(sum, 0u);
}

// A light that is 1e-12 of the whole keeps a chance, and sums stay exact over many chunks.
TEST(pdf, tiny_weights_keep_a_chance) {
    std::vector<float> row(5000, 1e-9f);
    row[4000] = 1000;
    const std::vector<float> powers(row.size(), 1);
    FOR_EACH_DEVICE(device) {
        const std::vector<uint> cdf = cdf_of(device, row, powers, {1, 0, 0, 0});
        uint before = 0;
        for (const uint sum : cdf) {
            EXPECT_GT(sum, before);
            before = sum;
        }
        EXPECT_NEAR(cdf.back() / double{CDF_SCALE}, 1, 1e-5);
    }
}

}  // namespace manylight

// SPDX-License-Identifier: MIT
#include "reference/contributions.hpp"

#include <bit>

#include "support.hpp"

namespace manylight {

TEST(contributions, agree_with_the_reference) {
    FOR_EACH_DEVICE(device)
    for (const std::string& scene : test::scene_names()) {
        SCOPED_TRACE(scene);
        test::expect_stage("contributions", test::verifier(scene, device));
    }
}

namespace {

// The matrix of the image's first pixel, which hits the scene, and of no representative.
Matrix evaluate(Device device, const test::TestScene& scene) {
    const unsigned lanes = device.form().bvh_width;
    const WideBvh bvh = build_wide_bvh(scene.scene, lanes, lanes, 5);
    const DeviceScene uploaded = upload_scene(device, scene.scene, bvh, scene.camera);
    const Tiles tiles = all_tiles(8, 8, 8);
    Buffer<Surface> surfaces = device.allocate<Surface>(64);
    GBufferStage(device, uploaded).trace(tiles, {}, surfaces);
    Matrix matrix(device, 2, static_cast<uint>(scene.scene.lights.size()));
    const Buffer<uint> representatives = device.upload(std::vector<uint>{0, NO_ITEM});
    ContributionStage(device, uploaded)
        .evaluate(surfaces, representatives, 0, 2, matrix, [](std::size_t) {});
    return matrix;
}

std::vector<float> values_of(const Matrix& matrix) {
    std::vector<float> values;
    for (const uint word : matrix.values.download()) values.push_back(std::bit_cast<float>(word));
    return values;
}

constexpr float pi = 3.14159265f;

}  // namespace

// Two lights over a plane, one of them behind a board: values and signs by hand.
TEST(contributions, hidden_lights_are_negative) {
    const test::TestScene scene = test::make_scene(
        [](GltfWriter& out) {
            Mesh plane;
            plane.add_quad({-5, 0, 5}, {10, 0, 0}, {0, 0, -10});
            Mesh board;
            board.add_quad({0.5f, 1, 0.5f}, {1, 0, 0}, {0, 0, -1});
            out.add_mesh("plane", plane, out.add_diffuse(glm::vec3(0.5f)));
            out.add_mesh("board", board, out.add_diffuse(glm::vec3(0.5f)));
            out.add_point({0, 2, 0}, glm::vec3(8));
            out.add_point({2, 2, 0}, glm::vec3(8));
            out.add_camera("down", {0, 4, 0.001f}, {0, 0, 0}, 0.002f, 1);
        },
        8, 8);
    FOR_EACH_DEVICE(device) {
        const Matrix matrix = evaluate(device, scene);
        const std::vector<float> values = values_of(matrix);
        ASSERT_EQ(values.size(), 4u);
        EXPECT_NEAR(values[0], 0.5f / pi * 8 / 4, 2e-3);  // f I / d^2, straight above
        // Direction (2, 2, 0): distance^2 8, cosine 1 / sqrt 2; the board is in between.
        EXPECT_NEAR(values[1], -0.5f / pi * 8 / 8 / std::sqrt(2.f), 2e-3);
        EXPECT_EQ(values[2], 0);
        EXPECT_EQ(values[3], 0);
        const std::vector<RowSum> totals = matrix.totals.download();
        EXPECT_EQ(totals[0].visible, values[0]);
        EXPECT_EQ(totals[0].unshadowed, values[0] - values[1]);
        EXPECT_EQ(totals[0].visible_count, 1u);
        EXPECT_EQ(totals[0].facing_count, 2u);
        EXPECT_EQ(totals[1].facing_count, 0u);
    }
}

// A parallelogram and a triangle at height 1, at whose corner the ray leaves the plane: each is a
// point at its centroid, f L A cos^2 / d^2.
TEST(contributions, area_lights_are_judged_by_their_centroid) {
    constexpr float s = 0.16f;
    const test::TestScene scene = test::make_scene(
        [](GltfWriter& out) {
            Mesh plane;
            plane.add_quad({-5, 0, 5}, {10, 0, 0}, {0, 0, -10});
            Mesh lamps;
            lamps.add_quad({0, 1, 0}, {s, 0, 0}, {0, 0, s});
            lamps.add_triangle({0, 1, 0}, {-s, 1, 0}, {0, 1, -s});
            out.add_mesh("plane", plane, out.add_diffuse(glm::vec3(0.5f)));
            out.add_mesh("lamps", lamps, out.add_emitter(glm::vec3(8)));
            out.add_camera("beside", {0, 0.5f, 0.5f}, {0, 0, 0}, 0.0002f, 1);
        },
        8, 8);
    ASSERT_EQ(scene.scene.lights.size(), 2u);
    ASSERT_EQ(scene.scene.lights[0].position.w, LIGHT_QUAD);
    ASSERT_EQ(scene.scene.lights[1].position.w, LIGHT_TRIANGLE);
    const auto expected = [](float area, float x) {
        const float d2 = 1 + 2 * x * x;
        return 0.5f / pi * 8 * area / (d2 * d2);
    };
    FOR_EACH_DEVICE(device) {
        const std::vector<float> values = values_of(evaluate(device, scene));
        EXPECT_NEAR(values[0], expected(s * s, s / 2), 5e-4 * values[0]);
        EXPECT_NEAR(values[1], expected(s * s / 2, s / 3), 5e-4 * values[1]);
    }
}

// GPUs trace single rays where CPUs trace packets: the same matrix, but for rays that graze edges.
TEST(contributions, packets_and_single_rays_agree) {
    const test::TestScene& s = test::scene_named("kinds");
    const Tiles tiles = all_tiles(s.width, s.height, 8);
    const auto lights = static_cast<uint>(s.scene.lights.size());
    FOR_EACH_DEVICE(device) {
        Device d = device;
        if (d.form().lanes == 1) continue;  // it has no packets
        const unsigned lanes = d.form().bvh_width;
        const WideBvh bvh = build_wide_bvh(s.scene, lanes, lanes, reach_of(s.scene, s.camera));
        DeviceScene uploaded = upload_scene(d, s.scene, bvh, s.camera);
        std::vector<uint> items;  // that hit something
        std::vector<float> values[2];
        for (const bool packets : {true, false}) {
            uploaded.packets = uploaded.primary_packets = packets;
            Buffer<Surface> surfaces = d.allocate<Surface>(item_count(tiles));
            GBufferStage(d, uploaded).trace(tiles, {}, surfaces);
            const std::vector<Surface> found = surfaces.download();
            if (items.empty())
                for (uint i = 0; i < item_count(tiles); i += 3)
                    if (found[i].position.w >= 0) items.push_back(i);
            const auto rows = static_cast<uint>(items.size());
            Matrix matrix(d, rows, lights);
            ContributionStage(d, uploaded)
                .evaluate(surfaces, d.upload(items), 0, rows, matrix, [](std::size_t) {});
            for (const uint word : matrix.values.download())
                values[packets].push_back(std::bit_cast<float>(word));
        }
        int different = 0;
        int hidden = 0;
        for (std::size_t i = 0; i < values[0].size(); ++i) {
            different += std::abs(values[0][i] - values[1][i]) > 1e-4f * std::abs(values[0][i]);
            hidden += values[0][i] < 0;
        }
        EXPECT_LE(different, static_cast<int>(values[0].size() / 500));
        EXPECT_GT(hidden, 500);
    }
}

}  // namespace manylight

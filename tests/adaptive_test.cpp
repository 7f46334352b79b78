// SPDX-License-Identifier: MIT
#include <cmath>

#include "support.hpp"
#include "verify/sampler_checks.hpp"

namespace manylight {

// Each stage of sampler adaptive on each scene, with every light a node and with groups of lights.
TEST(adaptive, stages_agree_with_the_reference) {
    FOR_EACH_DEVICE(device)
    for (const std::string& scene : test::scene_names())
        for (const uint cut_size : {5u, 40u, 256u}) {
            SCOPED_TRACE(fmt::format("{}, cuts of {}", scene, cut_size));
            for (const Check& check : check_adaptive(test::verifier(scene, device), cut_size))
                test::expect_pass(check);
        }
}

// Where light comes along the line of sight from behind, there is no half vector.
TEST(adaptive, light_from_straight_behind_a_glossy_surface) {
    test::TestScene scene = test::make_scene(
        [](GltfWriter& out) {
            Mesh floor;
            floor.add_quad({-4, 0, 4}, {8, 0, 0}, {0, 0, -8});
            out.add_mesh("floor", floor, out.add_material({0.8f, 0.7f, 0.6f}, 1, 0.2f));
            out.add_directional({0, 1, 0}, glm::vec3(3));
            for (int i = 0; i < 20; ++i) out.add_point({0.1f * i, 1, 0}, glm::vec3(1));
            out.add_camera("down", {0, 3, 1e-4f}, {0, 0, 0}, 0.5f, 1);
        },
        8, 8);
    View view = find_view(scene.scene, "");
    view.orthographic = true;
    view.to_world = {{1, 0, 0, 0}, {0, 0, -1, 0}, {0, 1, 0, 0}, {0, 3, 0, 1}};  // down
    view.half_height = 1;
    scene.camera = make_camera(view, scene.width, scene.height);
    for (Light& light : scene.scene.lights)
        if (light.axis.y > 0) light.axis = float4(0, 1, 0, 0);  // without rounding
    RenderOptions options;
    options.sampler = "adaptive";
    options.spp = 2;
    FOR_EACH_DEVICE(device)
    for (const float value : test::render(device, scene, options).image.values)
        EXPECT_TRUE(std::isfinite(value) && value > 0) << value;
}

}  // namespace manylight

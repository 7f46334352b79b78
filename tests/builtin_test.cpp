// SPDX-License-Identifier: MIT
#include "scene/builtin/builtin.hpp"

#include "error.hpp"
#include "scene/gltf.hpp"
#include "support.hpp"

namespace manylight {
namespace {

Scene load_builtin(const std::string& name, const BuiltinOptions& options = {}) {
    const std::string path = test::temporary(name + ".glb");
    make_builtin(name, options).write(path);
    Scene scene = load_scene(path);
    add_emitters(scene, scene.emitter_points.value_or(0));
    return scene;
}

}  // namespace

TEST(builtin, every_scene_has_its_lights) {
    const std::map<std::string, std::size_t> lights = {
        {"cornell", 64},  {"dragon", 100}, {"rooms", 10'000}, {"city", 100'000},
        {"glossy", 1000}, {"blinds", 192}, {"pinhole", 32},   {"plates", 36}};
    ASSERT_EQ(all_builtins().size(), lights.size());
    for (const auto& [name, count] : lights) {
        const Scene scene = load_builtin(name);
        EXPECT_EQ(scene.lights.size(), count) << name;
        EXPECT_EQ(scene.views.size(), name == "dragon" ? 2u : 1u) << name;
        EXPECT_TRUE(scene.warnings.empty()) << name;
        EXPECT_GE(scene.triangle_count(), 20u) << name;
        for (const Light& light : scene.lights) ASSERT_GT(light.emission.w, 0) << name;
    }
    EXPECT_GT(load_builtin("dragon").triangle_count(), 300'000u);
}

TEST(builtin, city_takes_a_number_of_lights) {
    EXPECT_EQ(load_builtin("city", {.lights = 777, .mesh = {}}).lights.size(), 777u);
    EXPECT_THROW((void)make_builtin("rooms", {.lights = 5, .mesh = {}}), InputError);
    EXPECT_THROW((void)make_builtin("village", {}), InputError);
}

TEST(builtin, dragon_takes_a_mesh) {
    GltfWriter writer;
    Mesh mesh;
    mesh.add_box({0, 0, 0}, {1, 2, 1});
    writer.add_mesh("box", mesh, writer.add_diffuse(glm::vec3(0.5f)));
    const std::string path = test::temporary("box.glb");
    writer.write(path);
    const Scene scene = load_builtin("dragon", {.lights = 0, .mesh = path});
    EXPECT_EQ(scene.triangle_count(), 12u + 10u + 8u);  // box, room, four lights
    EXPECT_THROW((void)make_builtin("cornell", {.lights = 0, .mesh = path}), InputError);
}

}  // namespace manylight

// SPDX-License-Identifier: MIT
#include "scene/builtin/builtin.hpp"

#include <cmath>
#include <cstring>

#include "error.hpp"
#include "scene/gltf/load.hpp"
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

bool alike(const Scene& a, const Scene& b) {
    const auto same = [](const auto& x, const auto& y) {
        return x.size() == y.size() &&
               (x.empty() || std::memcmp(x.data(), y.data(), x.size() * sizeof(x[0])) == 0);
    };
    return same(a.vertices, b.vertices) && same(a.lights, b.lights) &&
           same(a.materials, b.materials);
}

}  // namespace

TEST(builtin, every_scene_has_its_lights) {
    const std::map<std::string, std::size_t> lights = {
        {"cornell", 64},    {"dragon", 100},    {"rooms", 10'000}, {"city", 100'000},
        {"glossy", 1000},   {"blinds", 192},    {"pinhole", 32},   {"plates", 36},
        {"boards", 64},     {"hidden", 10'000}, {"near", 400},     {"range", 1000},
        {"stacks", 4096},   {"tubes", 304},     {"thicket", 120},  {"forest", 600},
        {"street", 10'000}, {"vault", 3003}};
    ASSERT_EQ(all_builtins().size(), lights.size());
    for (const auto& [name, count] : lights) {
        const Scene scene = load_builtin(name);
        EXPECT_EQ(scene.lights.size(), count) << name;
        EXPECT_EQ(scene.views.size(), name == "dragon" ? 2u : 1u) << name;
        EXPECT_TRUE(scene.warnings.empty()) << name;
        EXPECT_GE(scene.triangle_count(), 10u) << name;
        for (const Light& light : scene.lights) ASSERT_GT(light.emission.w, 0) << name;
    }
    EXPECT_GT(load_builtin("dragon").triangle_count(), 300'000u);
    const Scene forest = load_builtin("forest");
    EXPECT_GT(forest.seen_triangle_count(), 15'000'000u);
    EXPECT_LT(forest.triangle_count(), 11'000u);
}

TEST(builtin, scenes_take_their_numbers) {
    const auto given = [](const char* name, double value) {
        return BuiltinOptions{.values = {{name, value}}};
    };
    EXPECT_EQ(load_builtin("city", given("lights", 777)).lights.size(), 777u);
    EXPECT_THROW((void)make_builtin("rooms", given("lights", 5)), InputError);
    EXPECT_THROW((void)make_builtin("city", given("lights", 0)), InputError);
    EXPECT_THROW((void)make_builtin("city", given("lights", 7.5)), InputError);
    EXPECT_THROW((void)make_builtin("glossy", given("roughness", NAN)), InputError);
    EXPECT_THROW((void)make_builtin("village", {}), InputError);
}

// At both ends of a sweep there is a scene, and another one than usual.
TEST(builtin, sweeps_have_ends) {
    for (const Builtin& scene : all_builtins())
        for (const SceneParameter& p : scene.parameters) {
            const std::string name(scene.name);
            SCOPED_TRACE(fmt::format("{} --{}", name, p.name));
            EXPECT_GE(p.usual, p.least());
            EXPECT_LE(p.usual, p.most());
            const Scene usual = load_builtin(name);
            for (const double value : {p.sweep.front(), p.sweep.back()}) {
                if (p.name == "lights" && value > 1e5) continue;  // takes long
                const Scene made = load_builtin(name, {.values = {{std::string(p.name), value}}});
                EXPECT_TRUE(made.warnings.empty());
                EXPECT_GT(made.lights.size(), 0u);
                EXPECT_FALSE(alike(made, usual));
            }
        }
}

TEST(builtin, dragon_takes_a_mesh) {
    GltfWriter writer;
    Mesh mesh;
    mesh.add_box({0, 0, 0}, {1, 2, 1});
    writer.add_mesh("box", mesh, writer.add_diffuse(glm::vec3(0.5f)));
    const std::string path = test::temporary("box.glb");
    writer.write(path);
    const Scene scene = load_builtin("dragon", {.mesh = path});
    EXPECT_EQ(scene.triangle_count(), 12u + 10u + 8u);  // box, room, four lights
    EXPECT_THROW((void)make_builtin("cornell", {.mesh = path}), InputError);
}

}  // namespace manylight

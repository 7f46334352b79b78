// SPDX-License-Identifier: MIT
// What a glTF file means. Refusals are in malformed.py.
#include "scene/gltf.hpp"

#include <cstring>
#include <filesystem>
#include <fstream>
#include <glm/gtc/constants.hpp>

#include "error.hpp"
#include "support.hpp"

namespace manylight {
namespace {

using nlohmann::json;

// A .gltf file with its buffer beside it: one triangle (0 0 0, 1 0 0, 0 1 0), a square of four
// vertices as a strip, and indices of every type.
class GltfTest {
  public:
    json document;

    GltfTest() {
        const float positions[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0};
        const std::uint8_t bytes[] = {0, 1, 2, 0};
        const std::uint16_t shorts[] = {0, 1, 2, 0};
        const std::uint32_t words[] = {2, 1, 0};
        std::string data;
        const auto add = [&data](const auto& array) {
            data.append(reinterpret_cast<const char*>(array), sizeof(array));
        };
        add(positions);
        add(bytes);
        add(shorts);
        add(words);
        std::ofstream(test::temporary("data.bin"), std::ios::binary) << data;
        document = {
            {"asset", {{"version", "2.0"}}},
            {"scene", 0},
            {"scenes", {{{"nodes", {0}}}}},
            {"nodes", {{{"mesh", 0}}}},
            {"meshes", {{{"primitives", {{{"attributes", {{"POSITION", 0}}}}}}}}},
            {"accessors",
             {{{"bufferView", 0}, {"componentType", 5126}, {"count", 3}, {"type", "VEC3"}},
              {{"bufferView", 0}, {"componentType", 5126}, {"count", 4}, {"type", "VEC3"}},
              {{"bufferView", 1}, {"componentType", 5121}, {"count", 3}, {"type", "SCALAR"}},
              {{"bufferView", 2}, {"componentType", 5123}, {"count", 3}, {"type", "SCALAR"}},
              {{"bufferView", 3}, {"componentType", 5125}, {"count", 3}, {"type", "SCALAR"}}}},
            {"bufferViews",
             {{{"buffer", 0}, {"byteLength", 48}},
              {{"buffer", 0}, {"byteOffset", 48}, {"byteLength", 4}},
              {{"buffer", 0}, {"byteOffset", 52}, {"byteLength", 8}},
              {{"buffer", 0}, {"byteOffset", 60}, {"byteLength", 12}}}},
            {"buffers", {{{"byteLength", 72}, {"uri", "data.bin"}}}},
        };
    }

    json& primitive() { return document["meshes"][0]["primitives"][0]; }

    [[nodiscard]] Scene load() const {
        const std::string path = test::temporary("test.gltf");
        std::ofstream(path) << document;
        return load_scene(path);
    }
};

std::vector<glm::vec3> triangle(const Scene& scene, std::size_t t) {
    return {scene.vertices[scene.indices[3 * t]], scene.vertices[scene.indices[3 * t + 1]],
            scene.vertices[scene.indices[3 * t + 2]]};
}

glm::vec3 face_normal(const Scene& scene, std::size_t t) {
    const auto v = triangle(scene, t);
    return glm::normalize(glm::cross(v[1] - v[0], v[2] - v[0]));
}

void expect_near(glm::vec3 found, glm::vec3 expected) {
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(found[i], expected[i], 1e-5);
}

}  // namespace

TEST(gltf, plain_triangle) {
    const Scene scene = GltfTest().load();
    ASSERT_EQ(scene.triangle_count(), 1u);
    expect_near(triangle(scene, 0)[2], {0, 1, 0});
    EXPECT_TRUE(scene.vertex_normals.empty());
    EXPECT_TRUE(scene.warnings.empty());
    // No material: glTF's default, a white rough metal.
    const Material& m = scene.materials[scene.triangle_materials[0]];
    EXPECT_EQ(m.base_color, float4(1, 1, 1, 1));
    EXPECT_EQ(m.roughness, 1);
}

TEST(gltf, indices_of_every_type) {
    for (const int accessor : {2, 3, 4}) {
        GltfTest file;
        file.primitive()["indices"] = accessor;
        const Scene scene = file.load();
        ASSERT_EQ(scene.triangle_count(), 1u);
        expect_near(triangle(scene, 0)[0], accessor == 4 ? glm::vec3(0, 1, 0) : glm::vec3(0));
    }
}

// The triangles of a strip and of a fan over (0 0, 1 0, 0 1, 1 1) as glTF lists them.
TEST(gltf, strips_and_fans) {
    GltfTest file;
    file.primitive()["attributes"]["POSITION"] = 1;
    file.primitive()["mode"] = 5;
    Scene scene = file.load();
    ASSERT_EQ(scene.triangle_count(), 2u);
    expect_near(face_normal(scene, 0), {0, 0, 1});
    expect_near(face_normal(scene, 1), {0, 0, 1});
    file.primitive()["mode"] = 6;
    scene = file.load();
    ASSERT_EQ(scene.triangle_count(), 2u);
    expect_near(triangle(scene, 1)[0], {0, 1, 0});
    expect_near(triangle(scene, 1)[1], {1, 1, 0});
    expect_near(triangle(scene, 1)[2], {0, 0, 0});
}

TEST(gltf, lines_and_points_are_warned_about) {
    GltfTest file;
    file.primitive()["mode"] = 1;
    const Scene scene = file.load();
    EXPECT_EQ(scene.triangle_count(), 0u);
    ASSERT_EQ(scene.warnings.size(), 1u);
    EXPECT_NE(scene.warnings[0].find("points or lines"), std::string::npos);
}

// Scale, then rotation, then translation, parents after children.
TEST(gltf, node_transforms) {
    GltfTest file;
    const double h = std::sqrt(0.5);
    file.document["nodes"] = {{{"children", {1}}, {"translation", {10, 0, 0}}},
                              {{"mesh", 0},
                               {"translation", {0, 0, 5}},
                               {"rotation", {0, 0, h, h}},  // a quarter turn about z
                               {"scale", {2, 3, 1}}}};
    const Scene scene = file.load();
    expect_near(triangle(scene, 0)[1], {10, 2, 5});  // x 1, doubled, turned to y
    expect_near(triangle(scene, 0)[2], {7, 0, 5});   // y 1, tripled, turned to -x
}

TEST(gltf, matrices_are_column_major) {
    GltfTest file;
    file.document["nodes"][0]["matrix"] = {0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0, 4, 5, 6, 1};
    const Scene scene = file.load();
    expect_near(triangle(scene, 0)[1], {4, 6, 6});
}

// A mirroring transform turns the winding, so that the front stays the front.
TEST(gltf, mirrored_nodes_keep_their_front) {
    GltfTest file;
    file.document["nodes"][0]["scale"] = {-1, 1, 1};
    expect_near(face_normal(file.load(), 0), {0, 0, 1});
}

// Normals go with the inverse transpose, and are unit.
TEST(gltf, normals_under_scale) {
    GltfTest file;
    file.primitive()["attributes"]["NORMAL"] = 0;  // (0 0 0), (1 0 0), (0 1 0)
    file.document["nodes"][0]["scale"] = {2, 4, 1};
    const Scene scene = file.load();
    ASSERT_EQ(scene.vertex_normals.size(), 3u);
    EXPECT_EQ(scene.vertex_normals[0], glm::vec3(0));  // none: flat
    expect_near(scene.vertex_normals[1], {1, 0, 0});
    expect_near(scene.vertex_normals[2], {0, 1, 0});
    // (1 1 0) at the square's corner (1 1 0): its normal is (1/2, 1/4, 0), made unit.
    file.primitive()["attributes"] = {{"POSITION", 1}, {"NORMAL", 1}};
    file.primitive()["mode"] = 5;
    const Scene square = file.load();
    const auto corner = std::ranges::find(square.vertices, glm::vec3(2, 4, 0));
    ASSERT_NE(corner, square.vertices.end());
    expect_near(square.vertex_normals[corner - square.vertices.begin()],
                {2 / std::sqrt(5.f), 1 / std::sqrt(5.f), 0});
}

TEST(gltf, only_the_chosen_scene) {
    GltfTest file;
    file.document["nodes"] = {{{"mesh", 0}}, {{"mesh", 0}, {"translation", {5, 0, 0}}}};
    file.document["scenes"] = {{{"nodes", {0}}}, {{"nodes", {1}}}};
    file.document["scene"] = 1;
    const Scene scene = file.load();
    ASSERT_EQ(scene.triangle_count(), 1u);
    expect_near(triangle(scene, 0)[0], {5, 0, 0});
}

TEST(gltf, cameras) {
    GltfTest file;
    file.document["cameras"] = {
        {{"type", "perspective"},
         {"perspective", {{"yfov", 1.0}, {"aspectRatio", 2}, {"znear", 0.1}}}},
        {{"type", "orthographic"},
         {"orthographic", {{"xmag", 3}, {"ymag", 1.5}, {"znear", 0}, {"zfar", 10}}}}};
    const double h = std::sqrt(0.5);
    file.document["nodes"] = {
        {{"mesh", 0}},
        {{"camera", 0}, {"name", "main"}, {"translation", {1, 2, 3}}, {"scale", {5, 5, 5}}},
        {{"camera", 1}, {"name", "side"}, {"rotation", {0, h, 0, h}}}};
    file.document["scenes"][0]["nodes"] = {0, 1, 2};
    const Scene scene = file.load();
    ASSERT_EQ(scene.views.size(), 2u);
    EXPECT_EQ(find_view(scene, "").name, "main");
    const Camera main = make_camera(find_view(scene, "main"), 400, 200);
    expect_near(main.origin, {1, 2, 3});
    expect_near(main.forward, {0, 0, -1});
    expect_near(main.up, {0, std::tan(0.5f), 0});
    expect_near(main.right, {2 * std::tan(0.5f), 0, 0});
    EXPECT_EQ(main.forward.w, 0);
    // A quarter turn about y: -z becomes -x, x becomes -z.
    const Camera side = make_camera(find_view(scene, "side"), 400, 200);
    expect_near(side.forward, {-1, 0, 0});
    expect_near(side.right, {0, 0, -3});
    EXPECT_EQ(side.forward.w, 1);
    EXPECT_THROW((void)find_view(scene, "top"), InputError);
}

// Without a camera the whole scene is in view.
TEST(gltf, a_scene_without_camera_is_framed) {
    GltfTest file;
    file.document["nodes"][0]["scale"] = {40, 7, 3};
    const Scene scene = file.load();
    const Camera camera = make_camera(find_view(scene, ""), 100, 100);
    for (const glm::vec3& p : scene.vertices) {
        const glm::vec3 d = p - glm::vec3(camera.origin);
        const float depth = glm::dot(d, glm::vec3(camera.forward));
        EXPECT_GT(depth, 0);
        for (const float4& axis : {camera.right, camera.up}) {
            const glm::vec3 a(axis);
            EXPECT_LE(std::abs(glm::dot(d, a) / glm::dot(a, a)), depth);
        }
    }
}

TEST(gltf, materials) {
    GltfTest file;
    file.document["materials"] = {{{"pbrMetallicRoughness",
                                    {{"baseColorFactor", {0.1, 0.2, 0.3, 1}},
                                     {"metallicFactor", 0.25},
                                     {"roughnessFactor", 0.5}}},
                                   {"emissiveFactor", {1, 0.5, 0}},
                                   {"doubleSided", true},
                                   {"extensions",
                                    {{"KHR_materials_emissive_strength", {{"emissiveStrength", 8}}},
                                     {"KHR_materials_specular", {{"specularFactor", 0.3}}}}}}};
    file.primitive()["material"] = 0;
    const Scene scene = file.load();
    const Material& m = scene.materials[scene.triangle_materials[0]];
    EXPECT_EQ(m.base_color, float4(0.1f, 0.2f, 0.3f, 0.25f));
    EXPECT_EQ(m.roughness, 0.25f);  // alpha is the square
    EXPECT_EQ(m.specular, 0.3f);
    EXPECT_EQ(m.emission, float4(8, 4, 0, 1));
    Scene lit = scene;
    add_emitters(lit, 0);
    float power = 0;
    for (const Light& light : lit.lights) {
        EXPECT_EQ(light.axis.w, 1);  // both sides
        power += light.emission.w;
    }
    EXPECT_NEAR(power, 2 * glm::pi<float>() * 0.5f * luminance(glm::vec3(8, 4, 0)), 1e-4);
}

TEST(gltf, punctual_lights) {
    GltfTest file;
    file.document["extensions"]["KHR_lights_punctual"]["lights"] = {
        {{"type", "point"}, {"color", {1, 0.5, 0}}, {"intensity", 20}, {"range", 7}},
        {{"type", "spot"},
         {"intensity", 3},
         {"spot", {{"innerConeAngle", 0.2}, {"outerConeAngle", 0.6}}}},
        {{"type", "directional"}, {"intensity", 2}}};
    const double h = std::sqrt(0.5);
    const auto node = [&](int light) {
        return json{{"translation", {1, 2, 3}},
                    {"rotation", {h, 0, 0, h}},  // a quarter turn about x: -z becomes y
                    {"scale", {1, 1, 9}},        // does not count
                    {"extensions", {{"KHR_lights_punctual", {{"light", light}}}}}};
    };
    file.document["nodes"] = {{{"mesh", 0}}, node(0), node(1), node(2)};
    file.document["scenes"][0]["nodes"] = {0, 1, 2, 3};
    const Scene scene = file.load();
    ASSERT_EQ(scene.lights.size(), 3u);
    const Light& point = scene.lights[0];
    EXPECT_EQ(point.position, float4(1, 2, 3, LIGHT_POINT));
    EXPECT_EQ(glm::vec3(point.emission), glm::vec3(20, 10, 0));
    EXPECT_EQ(point.axis.w, 7);
    const Light& spot = scene.lights[1];
    EXPECT_EQ(spot.position.w, LIGHT_SPOT);
    expect_near(spot.axis, {0, 1, 0});
    EXPECT_NEAR(std::cos(0.2f) * spot.edge.x + spot.edge.y, 1, 1e-5);
    EXPECT_NEAR(std::cos(0.6f) * spot.edge.x + spot.edge.y, 0, 1e-5);
    EXPECT_EQ(scene.lights[2].position.w, LIGHT_DIRECTIONAL);
    expect_near(scene.lights[2].axis, {0, 1, 0});
}

TEST(gltf, embedded_data) {
    GltfTest file;
    file.document["bufferViews"] = {{{"buffer", 0}, {"byteLength", 36}}};
    while (file.document["accessors"].size() > 1) file.document["accessors"].erase(1);
    file.document["buffers"] = {
        {{"byteLength", 36},
         {"uri",
          "data:application/"
          "octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}}};
    const Scene scene = file.load();
    expect_near(triangle(scene, 0)[2], {0, 1, 0});
}

// Positions with other data between them.
TEST(gltf, strided_vertices) {
    GltfTest file;
    file.document["bufferViews"][0]["byteStride"] = 16;
    file.document["accessors"][1]["count"] = 3;
    const Scene scene = file.load();
    expect_near(triangle(scene, 0)[1], {0, 0, 0});  // floats 4 to 6
    expect_near(triangle(scene, 0)[2], {0, 1, 1});  // floats 8 to 10
}

TEST(gltf, what_is_not_rendered_is_warned_about) {
    GltfTest file;
    file.document["extensionsUsed"] = {"KHR_materials_clearcoat", "KHR_materials_specular"};
    file.document["images"] = {{{"uri", "missing.png"}}};
    file.document["textures"] = {{{"source", 0}}};
    file.document["materials"] = {
        {{"extensions", {{"KHR_materials_specular", {{"specularTexture", {{"index", 0}}}}}}}}};
    file.document["skins"] = {{{"joints", {0}}}};
    file.document["animations"] = {{{"channels", json::array()}, {"samplers", json::array()}}};
    file.primitive()["targets"] = {{{"POSITION", 0}}};
    std::string all;
    const Scene scene = file.load();
    for (const std::string& warning : scene.warnings) {
        EXPECT_EQ(warning.find(scene.file), 0u) << warning;
        EXPECT_EQ(warning.find('\n'), std::string::npos);
        all += warning + "\n";
    }
    for (const char* word :
         {"specular textures", "skins", "morph", "animations", "KHR_materials_clearcoat"})
        EXPECT_NE(all.find(word), std::string::npos) << word;
    EXPECT_EQ(scene.warnings.size(), 5u) << all;
}

// F0 = ((ior - 1) / (ior + 1))^2, times the colour, at most 1; an unlit material shines alone.
TEST(gltf, reflectance_and_unlit) {
    GltfTest file;
    json& material = file.document["materials"][0];
    material["extensions"]["KHR_materials_ior"]["ior"] = 2;
    material["extensions"]["KHR_materials_specular"]["specularColorFactor"] = {1, 0.5, 20};
    EXPECT_EQ(file.load().warnings.size(), 0u);
    expect_near(glm::vec3(file.load().materials[0].reflectance), {1 / 9.f, 1 / 18.f, 1});
    material["extensions"]["KHR_materials_ior"]["ior"] = 0;
    expect_near(glm::vec3(file.load().materials[0].reflectance), {1, 0.5f, 1});
    material = {{"pbrMetallicRoughness", {{"baseColorFactor", {0.1, 0.2, 0.3, 1}}}},
                {"extensions", {{"KHR_materials_unlit", json::object()}}}};
    file.primitive()["material"] = 0;
    Scene scene = file.load();
    add_emitters(scene, 0);
    expect_near(glm::vec3(scene.materials[0].emission), {0.1f, 0.2f, 0.3f});
    expect_near(glm::vec3(scene.materials[0].base_color), glm::vec3(0));
    EXPECT_TRUE(scene.lights.empty());
}

TEST(gltf, emitter_points_of_the_file) {
    GltfTest file;
    EXPECT_FALSE(file.load().emitter_points.has_value());
    file.document["scenes"][0]["extras"]["emitter_points"] = 64;
    EXPECT_EQ(file.load().emitter_points, 64u);
}

}  // namespace manylight

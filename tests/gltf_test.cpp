// SPDX-License-Identifier: MIT
// What a glTF file means. Refusals are in malformed.py.
#include "scene/gltf/load.hpp"

#include <draco/compression/encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>
#include <meshoptimizer.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <glm/gtc/constants.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include "error.hpp"
#include "gltf_file.hpp"

namespace manylight {
namespace {

using nlohmann::json;
using test::expect_near;
using test::GltfTest;
using test::triangle;

glm::vec3 face_normal(const Scene& scene, std::size_t t) {
    const auto v = triangle(scene, t);
    return glm::normalize(glm::cross(v[1] - v[0], v[2] - v[0]));
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

// What a framed view shows of the vertices: the part of the image's width, and height, that they
// take; they are in its middle.
glm::dvec2 filled_part(const Scene& scene, double aspect) {
    const Camera camera =
        make_camera(find_view(scene, "", aspect), static_cast<unsigned>(1000 * aspect), 1000);
    Bounds image;
    for (const std::uint32_t vertex : scene.indices) {
        const glm::dvec3 d = glm::dvec3(scene.vertices[vertex]) - glm::dvec3(camera.origin);
        const double depth = glm::dot(d, glm::dvec3(camera.forward));
        EXPECT_GT(depth, 0);
        const auto along = [&](const glm::dvec3& side) {
            return glm::dot(d, side) / glm::dot(side, side) / depth;
        };
        image.add({along(glm::dvec3(camera.right)), along(glm::dvec3(camera.up)), 0});
    }
    EXPECT_LT(glm::length(image.centre()), 1e-3);
    return glm::dvec2(image.upper - image.lower) / 2.0;
}

// Without a camera the whole scene is in view and fills it, whatever its size and shape.
TEST(gltf, a_scene_without_camera_is_framed) {
    for (const double size : {1e-6, 3e-4, 1.0, 1e6})
        for (const json& shape : {json{1, 1, 1}, {40, 7, 3}, {1, 90, 2}, {1, 2, 900}})
            for (const double aspect : {16.0 / 9, 1.0, 0.5}) {
                GltfTest file;
                file.document["nodes"][0]["scale"] = {size * shape[0].get<double>(),
                                                      size * shape[1].get<double>(),
                                                      size * shape[2].get<double>()};
                // A vertex that no triangle has.
                file.primitive() = {{"attributes", {{"POSITION", 1}}}, {"indices", 2}};
                const glm::dvec2 filled = filled_part(file.load(), aspect);
                EXPECT_NEAR(std::max(filled.x, filled.y), 0.85, 1e-3)
                    << size << ' ' << shape << ' ' << aspect;
            }
}

// Instances count where they stand.
TEST(gltf, instances_are_framed) {
    GltfTest file;
    const std::vector<float> places = {0, 0, 0, 5, 0, 0, 9, 1, -3};
    const int translations = file.add_floats(places, "VEC3", 3);
    file.document["extensionsUsed"] = {"EXT_mesh_gpu_instancing"};
    file.document["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"] = {
        {"attributes", {{"TRANSLATION", translations}}}};
    const Scene copied = file.load(LoadOptions{.storage = MeshStorage::copied});
    const glm::dvec2 filled = filled_part(copied, 1.5);
    EXPECT_NEAR(std::max(filled.x, filled.y), 0.85, 1e-3);
    Scene shared = copied;
    SharedMesh mesh{0, 1, 0, 3, {}};
    for (int v = 0; v < 3; ++v) mesh.bounds.add(copied.vertices[v]);
    shared.shared_meshes = {mesh};
    for (std::size_t i = 0; i < 3; ++i)
        shared.instances.push_back(make_instance(glm::translate(
            glm::dmat4(1), glm::dvec3(places[3 * i], places[3 * i + 1], places[3 * i + 2]))));
    const View a = find_view(copied, "", 1.5);
    const View b = find_view(shared, "", 1.5);
    EXPECT_LT(glm::distance(a.to_world[3], b.to_world[3]), 1e-6);
}

// Lights at the camera: where it is, and what it gives a white surface there.
TEST(gltf, headlights) {
    GltfTest file;
    file.document["nodes"][0]["translation"] = {0, 0, -0.9};
    Scene scene = file.load();
    EXPECT_TRUE(is_dark(scene));
    View view;
    view.near = 0.5;
    add_headlight(scene, view);
    ASSERT_EQ(scene.lights.size(), 1u);
    EXPECT_FALSE(is_dark(scene));
    EXPECT_EQ(scene.lights[0].position, float4(0, 0, -0.5f, LIGHT_POINT));
    EXPECT_EQ(scene.light_names.back(), "headlight");
    const double d2 = 0.25 + 0.25 + 0.4 * 0.4;  // to the middle of the triangle's bounds
    EXPECT_NEAR(scene.lights[0].emission.r / d2, M_PI, 1e-5);
    EXPECT_NEAR(scene.lights[0].emission.w / (4 * M_PI * M_PI * d2), 1, 1e-5);
    view.orthographic = true;
    scene.lights.insert(scene.lights.begin(), {Light{}});  // the file's own come first
    add_headlight(scene, view);
    EXPECT_EQ(scene.lights.size(), 3u);
    EXPECT_EQ(scene.lights[1].position.w, LIGHT_DIRECTIONAL);
    expect_near(scene.lights[1].axis, {0, 0, -1});
    EXPECT_EQ(scene.lights[1].edge, float4(0.5f, 1, 0, 0));  // its near plane, along its axis
    EXPECT_NEAR(scene.lights[1].emission.r, M_PI, 1e-6);
    EXPECT_GT(scene.lights[1].emission.w, 0);
}

// Unlit surfaces show by themselves, unless they are black.
TEST(gltf, unlit_scenes_are_not_dark) {
    GltfTest file;
    file.document["extensionsUsed"] = {"KHR_materials_unlit"};
    file.document["materials"] = {{{"extensions", {{"KHR_materials_unlit", json::object()}}}}};
    EXPECT_TRUE(is_dark(file.load()));  // nothing is of the material
    file.primitive()["material"] = 0;
    EXPECT_FALSE(is_dark(file.load()));
    file.document["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"] = {0, 0, 0, 1};
    EXPECT_TRUE(is_dark(file.load()));
}

// The planes between which a camera sees.
TEST(gltf, clipping_planes) {
    GltfTest file;
    file.document["cameras"] = {
        {{"type", "perspective"}, {"perspective", {{"yfov", 1.0}, {"znear", 0.1}}}},
        {{"type", "perspective"}, {"perspective", {{"yfov", 1.0}, {"znear", 2}, {"zfar", 7}}}},
        {{"type", "orthographic"},
         {"orthographic", {{"xmag", 1}, {"ymag", 1}, {"znear", 3}, {"zfar", 9}}}}};
    file.document["nodes"] = {{{"mesh", 0}}, {{"camera", 0}}, {{"camera", 1}}, {{"camera", 2}}};
    file.document["scenes"][0]["nodes"] = {0, 1, 2, 3};
    const Scene scene = file.load();
    const std::pair<float, float> expected[] = {{0.1f, 0}, {2, 7}, {3, 9}};
    for (int i = 0; i < 3; ++i) {
        const Camera camera = make_camera(scene.views[i], 100, 100);
        EXPECT_EQ(camera.right.w, expected[i].first);
        EXPECT_EQ(camera.up.w, expected[i].second);
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
    EXPECT_NEAR((spot.edge.y - (1 - std::cos(0.2f))) * spot.edge.x, 1, 1e-5);
    EXPECT_NEAR((spot.edge.y - (1 - std::cos(0.6f))) * spot.edge.x, 0, 1e-5);
    EXPECT_EQ(scene.lights[2].position.w, LIGHT_DIRECTIONAL);
    expect_near(scene.lights[2].axis, {0, 1, 0});
    const Scene scaled = file.load({.lamp_scale = 0.5});
    for (int i = 0; i < 3; ++i)
        EXPECT_EQ(glm::vec3(scaled.lights[i].emission), 0.5f * glm::vec3(scene.lights[i].emission));
}

// As Blender exports spots without blend.
TEST(gltf, sharp_spots) {
    GltfTest file;
    file.document["extensions"]["KHR_lights_punctual"]["lights"] = {
        {{"type", "spot"}, {"spot", {{"innerConeAngle", 0.5}, {"outerConeAngle", 0.5}}}}};
    file.document["nodes"].push_back({{"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
    file.document["scenes"][0]["nodes"] = {0, 1};
    const Light spot = file.load().lights.at(0);
    const auto falloff = [&](double angle) {
        return std::clamp((spot.edge.y - static_cast<float>(1 - std::cos(angle))) * spot.edge.x,
                          0.f, 1.f);
    };
    EXPECT_EQ(falloff(0.4999), 1);
    EXPECT_EQ(falloff(0.5001), 0);
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

// Names are decoded once; a % that codes nothing stands for itself, as does a plus. Links within
// the folder are followed, and a file may be longer than its buffer.
TEST(gltf, names_of_files) {
    namespace fs = std::filesystem;
    GltfTest file;
    const fs::path folder = test::temporary("folder");
    fs::create_directory(folder);
    const auto name = [&](const std::string& text) {
        file.document["buffers"][0]["uri"] = folder.filename().string() + "/" + text;
    };
    const fs::path data = test::temporary("data.bin");
    for (const auto& [uri, written] :
         {std::pair{"a%20b%25.bin", "a b%.bin"}, std::pair{"100%.bin", "100%.bin"},
          std::pair{"%zz+%2B.bin", "%zz++.bin"}, std::pair{"%252e.bin", "%2e.bin"},
          std::pair{"%C3%A9.bin", "\xc3\xa9.bin"}, std::pair{"./x/y.bin", "x/y.bin"}}) {
        fs::create_directories((folder / written).parent_path());
        fs::copy_file(data, folder / written, fs::copy_options::overwrite_existing);
        std::ofstream(folder / written, std::ios::app) << "more than byteLength says";
        name(uri);
        const Scene scene = file.load();
        ASSERT_EQ(scene.triangle_count(), 1u) << uri;
        ASSERT_EQ(scene.files.size(), 1u);
        EXPECT_TRUE(fs::equivalent(scene.files[0], folder / written));
    }
    fs::create_symlink("x/y.bin", folder / "link.bin");
    name("link.bin");
    EXPECT_EQ(file.load().triangle_count(), 1u);
    fs::remove_all(folder);
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

// Some elements are others than those of the buffer view, or than zeros.
TEST(gltf, sparse_accessors) {
    GltfTest file;
    const int numbers = file.add(std::vector<std::uint8_t>{1}, 5121, "SCALAR", 1);
    const int values = file.add_floats({3, 4, 5}, "VEC3", 1);
    const json sparse = {
        {"count", 1},
        {"indices",
         {{"bufferView", file.document["accessors"][numbers]["bufferView"]},
          {"componentType", 5121}}},
        {"values", {{"bufferView", file.document["accessors"][values]["bufferView"]}}}};
    file.document["accessors"][0]["sparse"] = sparse;
    std::vector<glm::vec3> found = triangle(file.load(), 0);
    expect_near(found[1], {3, 4, 5});
    expect_near(found[2], {0, 1, 0});
    file.document["accessors"][0].erase("bufferView");
    found = triangle(file.load(), 0);
    expect_near(found[1], {3, 4, 5});
    expect_near(found[2], {0, 0, 0});
}

// KHR_mesh_quantization: integers as they are, or as fractions from -1 to 1.
TEST(gltf, quantized_attributes) {
    GltfTest file;
    const std::vector<std::int16_t> shorts = {-32768, 0, 0, 0, 32767, 0, 0, 0, 0, -16384, 0, 0};
    const int index = file.add(shorts, 5122, "VEC3", 3);
    json& view = file.document["bufferViews"].back();
    view["byteStride"] = 8;
    file.primitive()["attributes"]["POSITION"] = index;
    const std::vector<std::int8_t> bytes = {0, 0, 127, 0, 0, 0, -128, 0, 0, 127, 0, 0};
    file.primitive()["attributes"]["NORMAL"] = file.add(bytes, 5120, "VEC3", 3);
    file.document["bufferViews"].back()["byteStride"] = 4;
    file.document["accessors"].back()["normalized"] = true;
    EXPECT_THROW((void)file.load(), InputError);
    file.document["extensionsUsed"] = {"KHR_mesh_quantization"};
    file.document["extensionsRequired"] = {"KHR_mesh_quantization"};
    Scene scene = file.load();
    expect_near(triangle(scene, 0)[0], {-32768, 0, 0});
    expect_near(triangle(scene, 0)[2], {0, -16384, 0});
    expect_near(glm::vec3(scene.vertex_normals[1]), {0, 0, -1});
    EXPECT_TRUE(scene.warnings.empty());
    file.document["accessors"][index]["normalized"] = true;
    scene = file.load();
    expect_near(triangle(scene, 0)[0], {-1, 0, 0});
    expect_near(triangle(scene, 0)[1], {1, 0, 0});
    expect_near(triangle(scene, 0)[2], {0, -16384 / 32767.f, 0});
}

// Of a mesh and one of its attributes, parts within parts.
std::unique_ptr<draco::GeometryMetadata> draco_metadata(std::uint32_t attribute) {
    auto whole = std::make_unique<draco::GeometryMetadata>();
    whole->AddEntryString("name", "strip");
    for (const char* name : {"a", "b"}) {
        auto part = std::make_unique<draco::Metadata>();
        part->AddEntryInt("number", 3);
        auto small = std::make_unique<draco::Metadata>();
        small->AddEntryDoubleArray("numbers", std::vector<double>(100));
        part->AddSubMetadata("small", std::move(small));
        whole->AddSubMetadata(name, std::move(part));
    }
    auto one = std::make_unique<draco::AttributeMetadata>();
    one->set_att_unique_id(attribute);
    one->AddEntryString("unit", "none");
    whole->AddAttributeMetadata(std::move(one));
    return whole;
}

// KHR_draco_mesh_compression, written by the library's encoder: a strip of squares, its indices in
// all types; both of Draco's ways to store triangles, without metadata and with.
TEST(gltf, draco) {
    constexpr int squares = 5;
    constexpr int points = 2 * squares + 2;
    draco::TriangleSoupMeshBuilder builder;
    builder.Start(2 * squares);
    const int position =
        builder.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
    const int color =
        builder.AddAttribute(draco::GeometryAttribute::COLOR, 4, draco::DT_UINT8, true);
    const auto corner = [](int c) {
        return std::array<float, 3>{static_cast<float>(c / 2), static_cast<float>(c % 2), 0.5f};
    };
    const auto add_triangle = [&](int face, int a, int b, int c) {
        const std::array<float, 3> v[] = {corner(a), corner(b), corner(c)};
        const std::uint8_t colors[][4] = {{static_cast<std::uint8_t>(a), 0, 0, 255},
                                          {static_cast<std::uint8_t>(b), 0, 0, 255},
                                          {static_cast<std::uint8_t>(c), 0, 0, 255}};
        const draco::FaceIndex at(face);
        builder.SetAttributeValuesForFace(position, at, &v[0], &v[1], &v[2]);
        builder.SetAttributeValuesForFace(color, at, colors[0], colors[1], colors[2]);
    };
    for (int s = 0; s < squares; ++s) {
        add_triangle(2 * s, 2 * s, 2 * s + 2, 2 * s + 1);
        add_triangle(2 * s + 1, 2 * s + 1, 2 * s + 2, 2 * s + 3);
    }
    const std::unique_ptr<draco::Mesh> mesh = builder.Finalize();
    ASSERT_EQ(mesh->num_points(), unsigned{points});
    for (const auto& [has_metadata, is_edgebreaker] :
         {std::pair{false, false}, {false, true}, {true, false}, {true, true}}) {
        if (has_metadata) mesh->AddMetadata(draco_metadata(mesh->attribute(color)->unique_id()));
        for (const int type : {5121, 5123, 5125}) {
            draco::Encoder encoder;
            encoder.SetEncodingMethod(is_edgebreaker ? draco::MESH_EDGEBREAKER_ENCODING
                                                     : draco::MESH_SEQUENTIAL_ENCODING);
            draco::EncoderBuffer out;
            ASSERT_TRUE(encoder.EncodeMeshToBuffer(*mesh, &out).ok());
            GltfTest file;
            file.document["extensionsUsed"] = {"KHR_draco_mesh_compression"};
            file.document["extensionsRequired"] = {"KHR_draco_mesh_compression"};
            json& accessors = file.document["accessors"];
            const auto packed = file.add(std::vector<char>(out.data(), out.data() + out.size()),
                                         5121, "SCALAR", out.size());
            const json view = accessors[packed]["bufferView"];
            const std::size_t first = accessors.size();
            accessors.push_back({{"componentType", 5126}, {"type", "VEC3"}, {"count", points}});
            accessors.push_back({{"componentType", 5121},
                                 {"type", "VEC4"},
                                 {"count", points},
                                 {"normalized", true}});
            accessors.push_back(
                {{"componentType", type}, {"type", "SCALAR"}, {"count", 6 * squares}});
            file.primitive() = {{"attributes", {{"POSITION", first}, {"COLOR_0", first + 1}}},
                                {"indices", first + 2},
                                {"extensions",
                                 {{"KHR_draco_mesh_compression",
                                   {{"bufferView", view},
                                    {"attributes",
                                     {{"POSITION", mesh->attribute(position)->unique_id()},
                                      {"COLOR_0", mesh->attribute(color)->unique_id()}}}}}}}};
            const Scene scene = file.load();
            EXPECT_TRUE(scene.warnings.empty());
            ASSERT_EQ(scene.triangle_count(), std::size_t{2 * squares});
            ASSERT_EQ(scene.vertices.size(), std::size_t{points});
            double area = 0;
            for (std::size_t t = 0; t < scene.triangle_count(); ++t) {
                const std::vector<glm::vec3> v = triangle(scene, t);
                area += glm::cross(v[1] - v[0], v[2] - v[0]).z / 2;
                expect_near(face_normal(scene, t), {0, 0, 1});
            }
            EXPECT_NEAR(area, squares, 1e-4);
            for (std::size_t v = 0; v < scene.vertices.size(); ++v)
                EXPECT_NEAR(scene.colors[v].x * 255, 2 * scene.vertices[v].x + scene.vertices[v].y,
                            1e-3);
            json unsuited = file.document;
            std::swap(unsuited, file.document);
            file.document["accessors"][first + 2] = {
                {"componentType", 5126}, {"type", "VEC3"}, {"count", 6 * squares}};
            EXPECT_THROW((void)file.load(), InputError);
            std::swap(unsuited, file.document);
            // Numbers that the file does not announce.
            file.document["accessors"][first + 2]["count"] = 6 * squares - 3;
            EXPECT_THROW((void)file.load(), InputError);
        }
    }
}

// EXT_meshopt_compression, and KHR's by the same layout, written by the library's encoder:
// positions, indices, and normals as octahedra; the buffer that they would fill has no data,
// whether it says so or not.
TEST(gltf, compressed_buffer_views) {
    const std::vector<float> positions = {0, 0, 0, 0, 2, 0, 0, 0, 0, 3, 0, 0};  // VEC3 and a gap
    const std::vector<unsigned> corners = {0, 1, 2};
    const float normals[] = {0, 0, 1, 0, 0.6f, 0, 0.8f, 0, 0, -1, 0, 0};
    std::vector<std::int8_t> octahedra(12);
    meshopt_encodeFilterOct(octahedra.data(), 3, 4, 8, normals);
    for (const auto& [is_binary_indices, extension, says_so] :
         {std::tuple{false, "EXT_meshopt_compression", true},
          std::tuple{true, "EXT_meshopt_compression", false},
          std::tuple{true, "KHR_meshopt_compression", true}}) {
        GltfTest file;
        file.document["extensionsUsed"] = {extension, "KHR_mesh_quantization"};
        file.document["extensionsRequired"] = {extension};
        const auto add = [&](const void* data, std::size_t stride, const char* mode, json more,
                             json accessor) {
            const bool vertices = std::string(mode) == "ATTRIBUTES";
            std::vector<unsigned char> out(1000);
            out.resize(vertices ? meshopt_encodeVertexBuffer(out.data(), 1000, data, 3, stride)
                       : std::string(mode) == "TRIANGLES"
                           ? meshopt_encodeIndexBuffer(out.data(), 1000, corners.data(), 3)
                           : meshopt_encodeIndexSequence(out.data(), 1000, corners.data(), 3));
            const int index = file.add(out, 5121, "SCALAR", out.size());
            const std::size_t packed = file.document["buffers"].size() - 1;
            more.update({{"buffer", packed},
                         {"byteLength", out.size()},
                         {"byteStride", stride},
                         {"count", 3},
                         {"mode", mode}});
            file.document["buffers"].push_back({{"byteLength", 3 * stride}});
            if (says_so)
                file.document["buffers"].back()["extensions"][extension]["fallback"] = true;
            file.document["bufferViews"].back() = {{"buffer", file.document["buffers"].size() - 1},
                                                   {"byteLength", 3 * stride},
                                                   {"extensions", {{extension, more}}}};
            if (vertices) file.document["bufferViews"].back()["byteStride"] = stride;
            accessor["bufferView"] = file.document["bufferViews"].size() - 1;
            accessor["count"] = 3;
            file.document["accessors"][index] = accessor;
            return index;
        };
        json& attributes = file.primitive()["attributes"];
        attributes["POSITION"] = add(positions.data(), 16, "ATTRIBUTES", json::object(),
                                     {{"componentType", 5126}, {"type", "VEC3"}});
        attributes["NORMAL"] =
            add(octahedra.data(), 4, "ATTRIBUTES", {{"filter", "OCTAHEDRAL"}},
                {{"componentType", 5120}, {"type", "VEC3"}, {"normalized", true}});
        file.primitive()["indices"] =
            add(nullptr, 4, is_binary_indices ? "TRIANGLES" : "INDICES", json::object(),
                {{"componentType", 5125}, {"type", "SCALAR"}});
        const Scene scene = file.load();
        ASSERT_EQ(scene.triangle_count(), 1u);
        const std::vector<glm::vec3> found = triangle(scene, 0);
        EXPECT_EQ(found[0] + found[1] + found[2], glm::vec3(2, 3, 0));
        for (int i = 0; i < 3; ++i)
            for (int c = 0; c < 3; ++c)
                EXPECT_NEAR(scene.vertex_normals[i][c], normals[4 * i + c], 0.01) << i;
        EXPECT_TRUE(scene.warnings.empty());
    }
}

// EXT_mesh_gpu_instancing: moved, turned and scaled, in this order from the right.
TEST(gltf, instances_of_a_mesh) {
    GltfTest file;
    const float half = std::sqrt(0.5f);
    file.document["extensionsUsed"] = {"EXT_mesh_gpu_instancing"};
    file.document["nodes"][0]["translation"] = {100, 0, 0};
    file.document["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {
        {"TRANSLATION", file.add_floats({0, 0, 0, 5, 0, 0}, "VEC3", 2)},
        {"ROTATION", file.add_floats({0, 0, 0, 1, 0, 0, half, half}, "VEC4", 2)},
        {"SCALE", file.add_floats({1, 1, 1, 2, 2, 2}, "VEC3", 2)}};
    const Scene scene = file.load();
    ASSERT_EQ(scene.triangle_count(), 2u);
    expect_near(triangle(scene, 0)[1], {101, 0, 0});
    expect_near(triangle(scene, 1)[0], {105, 0, 0});
    expect_near(triangle(scene, 1)[1], {105, 2, 0});  // x, scaled by 2, turned to y
    EXPECT_TRUE(scene.warnings.empty());
    // Attributes of its own say nothing of places.
    json& instances = file.document["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"];
    instances["attributes"] = {{"_ID", instances["attributes"]["SCALE"]}};
    EXPECT_EQ(file.load().triangle_count(), 1u);
}

TEST(gltf, files_with_a_plus) {
    GltfTest file;
    const std::string old = file.document["buffers"][0]["uri"];
    const std::string name = "a+b " + old;
    std::filesystem::copy_file(test::temporary(old), test::temporary(name),
                               std::filesystem::copy_options::overwrite_existing);
    file.document["buffers"][0]["uri"] = name;
    const Scene scene = file.load();
    expect_near(triangle(scene, 0)[2], {0, 1, 0});
    ASSERT_EQ(scene.files.size(), 1u);
    EXPECT_TRUE(scene.files[0].ends_with(name));
}

// The node's weights, or else the mesh's.
TEST(gltf, morph_targets_at_rest) {
    GltfTest file;
    file.primitive()["targets"] = {
        {{"POSITION", file.add_floats({0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3", 3)}},
        {{"POSITION", file.add_floats({8, 0, 0, 0, 0, 0, 0, 0, 0}, "VEC3", 3)}}};
    expect_near(triangle(file.load(), 0)[1], {1, 0, 0});
    file.document["meshes"][0]["weights"] = {0.5, 0};
    expect_near(triangle(file.load(), 0)[1], {1, 0, 0.5});
    file.document["nodes"][0]["weights"] = {0.25, 0.5};
    expect_near(triangle(file.load(), 0)[0], {4, 0, 0.25});
    expect_near(triangle(file.load(), 0)[1], {1, 0, 0.25});
}

// Vertices go where their joints are, whatever the mesh's node.
TEST(gltf, skins_at_rest) {
    GltfTest file;
    file.document["nodes"] = {{{"mesh", 0}, {"skin", 0}, {"translation", {50, 0, 0}}},
                              {{"translation", {10, 0, 0}}, {"children", {2}}},
                              {{"translation", {0, 20, 0}}}};
    file.document["scenes"][0]["nodes"] = {0, 1};
    std::vector<float> bound(32, 0);
    for (int m = 0; m < 2; ++m)
        for (int i = 0; i < 16; ++i) bound[16 * m + i] = i % 5 == 0 ? 1 : 0;
    bound[14] = 7;  // the first joint's inverse moves by 7 along z
    file.document["skins"] = {
        {{"joints", {1, 2}}, {"inverseBindMatrices", file.add_floats(bound, "MAT4", 2)}}};
    file.primitive()["attributes"]["JOINTS_0"] =
        file.add(std::vector<std::uint8_t>{0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0}, 5121, "VEC4", 3);
    file.primitive()["attributes"]["WEIGHTS_0"] =
        file.add_floats({1, 0, 0, 0, 1, 0, 0, 0, 0.5f, 0.5f, 0, 0}, "VEC4", 3);
    const Scene scene = file.load();
    expect_near(triangle(scene, 0)[0], {10, 0, 7});
    expect_near(triangle(scene, 0)[1], {11, 20, 0});
    expect_near(triangle(scene, 0)[2], {10, 11, 3.5f});
    file.document["skins"][0]["joints"] = {1};
    EXPECT_THROW((void)file.load(), InputError);
}

// A moment of the first animation: every kind of channel and of interpolation.
TEST(gltf, animated_nodes) {
    GltfTest file;
    const float half = std::sqrt(0.5f);
    const int times = file.add_floats({1, 3}, "SCALAR", 2);
    file.document["nodes"][0]["scale"] = {2, 2, 2};
    const auto animate = [&](const char* path, int output, const char* interpolation) {
        file.document["animations"] = {
            {{"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", path}}}}}},
             {"samplers",
              {{{"input", times}, {"output", output}, {"interpolation", interpolation}}}}}};
    };
    const auto corner = [&](double seconds) { return triangle(file.load(seconds), 0)[1]; };
    const int moves = file.add_floats({0, 0, 0, 4, 0, 0}, "VEC3", 2);
    animate("translation", moves, "LINEAR");
    expect_near(corner(0), {2, 0, 0});
    expect_near(corner(1.5), {3, 0, 0});
    expect_near(corner(99), {6, 0, 0});
    EXPECT_EQ(file.load(1.0).warnings.size(), 0u);
    animate("translation", moves, "STEP");
    expect_near(corner(2.9), {2, 0, 0});
    expect_near(corner(3), {6, 0, 0});
    // Tangent, value, tangent: with tangents of 1 and 0 the middle of 2 s is at 2 + 2 / 8.
    animate("translation",
            file.add_floats({0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 4, 0, 0, 0, 0, 0}, "VEC3", 6),
            "CUBICSPLINE");
    expect_near(corner(2), {2 + 2.25f, 0, 0});
    animate("rotation", file.add_floats({0, 0, 0, 1, 0, 0, 1, 0}, "VEC4", 2), "LINEAR");
    expect_near(corner(2), {0, 2, 0});
    expect_near(corner(1.5), {2 * half, 2 * half, 0});
    animate("scale", file.add_floats({1, 1, 1, 5, 1, 1}, "VEC3", 2), "LINEAR");
    expect_near(corner(2), {3, 0, 0});
    file.primitive()["targets"] = {
        {{"POSITION", file.add_floats({0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3", 3)}},
        {{"POSITION", file.add_floats({0, 1, 0, 0, 1, 0, 0, 1, 0}, "VEC3", 3)}}};
    animate("weights", file.add_floats({0, 0, 1, 2}, "SCALAR", 4), "LINEAR");
    expect_near(corner(2), {2, 2, 1});
    animate("weights", file.add_floats({0, 0, 1}, "SCALAR", 3), "LINEAR");
    EXPECT_THROW((void)corner(2), InputError);
    animate("translation", moves, "LINEAR");
    file.document["animations"][0]["samplers"][0]["input"] = file.add_floats({3, 1}, "SCALAR", 2);
    EXPECT_THROW((void)corner(2), InputError);
    file.document.erase("animations");
    EXPECT_THROW((void)corner(2), InputError);
}

// What JSON pointers name: lights, materials, nodes, whether they show, and weights.
TEST(gltf, animated_by_pointers) {
    GltfTest file;
    file.document["extensionsRequired"] = {"KHR_animation_pointer"};
    file.document["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}}};
    file.document["nodes"].push_back({{"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
    file.document["scenes"][0]["nodes"] = {0, 1};
    file.document["materials"] = {{{"emissiveFactor", {0, 0, 0}}}};
    file.primitive()["material"] = 0;
    const int times = file.add_floats({1, 3}, "SCALAR", 2);
    const auto at = [&](const char* pointer, int output, const char* interpolation = "LINEAR") {
        const json target = {{"path", "pointer"},
                             {"extensions", {{"KHR_animation_pointer", {{"pointer", pointer}}}}}};
        file.document["animations"] = {
            {{"channels", {{{"sampler", 0}, {"target", target}}}},
             {"samplers",
              {{{"input", times}, {"output", output}, {"interpolation", interpolation}}}}}};
        return file.load(2.0);
    };
    const int numbers = file.add_floats({4, 8}, "SCALAR", 2);
    const Scene bright = at("/extensions/KHR_lights_punctual/lights/0/intensity", numbers);
    EXPECT_EQ(bright.lights[0].emission.x, 6);
    EXPECT_EQ(bright.warnings.size(), 0u);
    const int vectors = file.add_floats({0, 0, 0, 1, 0.5f, 0}, "VEC3", 2);
    EXPECT_EQ(glm::vec3(at("/materials/0/emissiveFactor", vectors).materials[0].emission),
              glm::vec3(0.5f, 0.25f, 0));
    EXPECT_EQ(glm::vec3(at("/nodes/1/translation", vectors).lights[0].position),
              glm::vec3(0.5f, 0.25f, 0));
    const int turns = file.add_floats({0, 0, 0, 1, 0, 0, 1, 0}, "VEC4", 2);
    expect_near(triangle(at("/nodes/0/rotation", turns), 0)[1], {0, 1, 0});
    file.document["nodes"][1]["extensions"]["KHR_node_visibility"] = {{"visible", true}};
    const int shown = file.add(std::vector<std::uint8_t>{0, 1}, 5121, "SCALAR", 2);
    EXPECT_TRUE(
        at("/nodes/1/extensions/KHR_node_visibility/visible", shown, "STEP").lights.empty());
    file.primitive()["targets"] = {
        {{"POSITION", file.add_floats({0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3", 3)}}};
    file.document["meshes"][0]["weights"] = {0};
    expect_near(triangle(at("/meshes/0/weights", numbers), 0)[0], {0, 0, 6});
    for (const char* pointer : {"/nodes/7/translation", "/nodes/x/translation", "/materials/~3"})
        EXPECT_THROW((void)at(pointer, vectors), InputError) << pointer;
    EXPECT_THROW((void)at("/cameras/0/perspective/yfov", numbers), InputError);
    for (const json& wrong : {json(5125), json("/nodes/0/translation"), json({{"pointer", 3}})}) {
        file.document["animations"][0]["channels"][0]["target"]["extensions"]
                     ["KHR_animation_pointer"] = wrong;
        EXPECT_THROW((void)file.load(2.0), InputError) << wrong;
    }
    file.document["animations"][0]["channels"][0]["target"]["path"] = -1;
    EXPECT_THROW((void)file.load(2.0), InputError);
    // What it makes of a value is checked as the value is.
    const int negative = file.add_floats({-4, -4}, "SCALAR", 2);
    EXPECT_THROW((void)at("/extensions/KHR_lights_punctual/lights/0/intensity", negative),
                 InputError);
}

TEST(gltf, what_is_not_rendered_is_warned_about) {
    GltfTest file;
    file.document["extensionsUsed"] = {"KHR_materials_clearcoat"};
    file.document["animations"] = {{{"channels", json::array()}, {"samplers", json::array()}}};
    std::string all;
    const Scene scene = file.load();
    for (const std::string& warning : scene.warnings) {
        EXPECT_EQ(warning.find(scene.file), 0u) << warning;
        EXPECT_EQ(warning.find('\n'), std::string::npos);
        all += warning + "\n";
    }
    for (const char* word : {"animations", "KHR_materials_clearcoat"})
        EXPECT_NE(all.find(word), std::string::npos) << word;
    EXPECT_EQ(scene.warnings.size(), 2u) << all;
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

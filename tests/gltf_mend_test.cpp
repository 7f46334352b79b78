// SPDX-License-Identifier: MIT
// Files that break glTF's rules and have one sensible reading, and extensions that choose what is
// shown.
#include <OpenImageIO/imageio.h>

#include <cmath>
#include <limits>

#include "error.hpp"
#include "gltf_file.hpp"
#include "scene/textures.hpp"

namespace manylight {
namespace {

using nlohmann::json;
using test::expect_near;
using test::GltfTest;
using test::triangle;

// One line that names the file, the place and what became of it.
void expect_one_warning(const Scene& scene, std::initializer_list<const char*> words) {
    ASSERT_EQ(scene.warnings.size(), 1u) << fmt::format("{}", fmt::join(scene.warnings, "\n"));
    EXPECT_EQ(scene.warnings[0].find(scene.file + ": "), 0u) << scene.warnings[0];
    for (const char* word : words)
        EXPECT_NE(scene.warnings[0].find(word), std::string::npos) << scene.warnings[0];
}

const Material& material_of(const Scene& scene, std::size_t triangle) {
    return scene.materials[scene.triangle_materials[triangle]];
}

// One texel, the same everywhere.
std::string write_texel(const std::string& name, std::array<unsigned char, 4> rgba) {
    const std::string path = test::temporary(name);
    OIIO::ImageSpec spec(1, 1, 4, OIIO::TypeDesc::UINT8);
    spec["oiio:UnassociatedAlpha"] = 1;
    const auto out = OIIO::ImageOutput::create(path);
    EXPECT_TRUE(out->open(path, spec) && out->write_image(OIIO::TypeDesc::UINT8, rgba.data()) &&
                out->close());
    return std::filesystem::path(path).filename().string();
}

// A triangle with coordinates, of one material.
GltfTest textured() {
    GltfTest file;
    file.primitive()["material"] = 0;
    file.primitive()["attributes"]["TEXCOORD_0"] = file.add_floats({0, 0, 1, 0, 0, 1}, "VEC2", 3);
    file.document["textures"] = {{{"source", 0}}};
    return file;
}

}  // namespace

// Parents move what a scene lists, whether they are listed or not.
TEST(gltf_mend, nodes_of_a_scene_that_are_children) {
    GltfTest file;
    file.document["nodes"] = {{{"children", {1}}, {"translation", {10, 0, 0}}},
                              {{"mesh", 0}, {"children", {2}}, {"translation", {0, 5, 0}}},
                              {{"mesh", 0}, {"translation", {0, 0, 2}}}};
    for (const json& listed :
         {json{0, 1}, json{1, 0}, json{2, 0, 1}, json{1}, json{1, 2}, json{1, 1}, json{0, 0}}) {
        file.document["scenes"][0]["nodes"] = listed;
        const Scene scene = file.load();
        ASSERT_EQ(scene.triangle_count(), 2u) << listed;
        expect_near(triangle(scene, 0)[0], {10, 5, 0});
        expect_near(triangle(scene, 1)[0], {10, 5, 2});
        expect_one_warning(scene, {"scenes[0].nodes[", "shown once"});
    }
    file.document["scenes"][0]["nodes"] = {2};
    ASSERT_EQ(file.load().triangle_count(), 1u);
    expect_near(triangle(file.load(), 0)[0], {10, 5, 2});
    file.document["scenes"][0]["nodes"] = {0};
    EXPECT_TRUE(file.load().warnings.empty());
}

// glTF allows that: all roots are shown.
TEST(gltf_mend, nodes_without_a_scene) {
    GltfTest file;
    file.document.erase("scene");
    file.document["nodes"] = {{{"mesh", 0}, {"children", {2}}},
                              {{"mesh", 0}, {"translation", {5, 0, 0}}},
                              {{"mesh", 0}, {"translation", {0, 7, 0}}}};
    for (const bool empty : {false, true}) {
        file.document.erase("scenes");
        if (empty) file.document["scenes"] = json::array();
        const Scene scene = file.load();
        EXPECT_EQ(scene.triangle_count(), 3u);
        EXPECT_TRUE(scene.warnings.empty());
    }
}

TEST(gltf_mend, rotations_that_are_nearly_unit) {
    GltfTest file;
    const double h = std::sqrt(0.5);
    for (const double length : {0.95, 0.998, 1.002, 1.09}) {
        file.document["nodes"] = {{{"mesh", 0}, {"rotation", {0, 0, length * h, length * h}}},
                                  {{"rotation", {length, 0, 0, 0}}}};
        const Scene scene = file.load();
        expect_near(triangle(scene, 0)[1], {0, 1, 0});
        expect_one_warning(scene, {"nodes[0].rotation", "1 more", "unit quaternion"});
    }
    file.document["nodes"][0]["rotation"] = {0, 0, 0.7071, 0.7071};
    file.document["nodes"][1].erase("rotation");
    EXPECT_TRUE(file.load().warnings.empty());
    for (const json& none : {json{0, 0, 0, 0.85}, json{1, 1, 1, 1}, json{0, 0, 0, 0}}) {
        file.document["nodes"][0]["rotation"] = none;
        EXPECT_THROW((void)file.load(), InputError) << none;
    }
}

TEST(gltf_mend, emission_above_1) {
    GltfTest file;
    file.primitive()["material"] = 0;
    file.document["materials"] = {{{"emissiveFactor", {2, 1.5, 0}}}};
    const Scene scene = file.load();
    EXPECT_EQ(glm::vec3(material_of(scene, 0).emission), glm::vec3(2, 1.5f, 0));
    expect_one_warning(scene, {"materials[0].emissiveFactor", "above 1"});
    for (const double bad : {-0.1, 1e30}) {
        file.document["materials"][0]["emissiveFactor"][0] = bad;
        EXPECT_THROW((void)file.load(), InputError) << bad;
    }
}

TEST(gltf_mend, empty_buffers_and_views) {
    GltfTest file;
    file.document["bufferViews"].push_back({{"buffer", 0}, {"byteLength", 0}});
    const Scene scene = file.load();
    EXPECT_EQ(scene.triangle_count(), 1u);
    expect_one_warning(scene, {"bufferViews[4].byteLength", "nothing is there"});
    file.document["buffers"].push_back(
        {{"byteLength", 0},
         {"uri", std::filesystem::path(test::temporary("empty.bin")).filename().string()}});
    std::ofstream(test::temporary("empty.bin")).flush();
    expect_one_warning(file.load(), {"buffers[1].byteLength", "1 more", "nothing is there"});
    file.document["accessors"][0]["bufferView"] = 4;
    EXPECT_THROW((void)file.load(), InputError);
}

// Exporters write accessors of 0 elements for empty meshes.
TEST(gltf_mend, accessors_of_no_elements) {
    GltfTest file;
    for (const json& empty : {json{{"componentType", 5126}, {"type", "VEC3"}, {"count", 0}},
                              json{{"componentType", 5126},
                                   {"type", "VEC3"},
                                   {"count", 0},
                                   {"bufferView", 0},
                                   {"byteOffset", 48}}}) {
        file.document["accessors"][5] = empty;
        file.document["meshes"][0]["primitives"][1] = {{"attributes", {{"POSITION", 5}}}};
        const Scene scene = file.load();
        EXPECT_EQ(scene.triangle_count(), 1u);
        expect_one_warning(scene, {"accessors[5].count", "is 0", "left out"});
    }
    file.document["accessors"][5] = {{"componentType", 5123}, {"type", "SCALAR"}, {"count", 0}};
    file.document["meshes"][0]["primitives"][1] = {{"attributes", {{"POSITION", 1}}},
                                                   {"indices", 5}};
    const Scene scene = file.load();
    EXPECT_EQ(scene.vertices.size(), 3u);  // of the other primitive alone
    expect_one_warning(scene, {"accessors[5].count"});
    // Values for vertices that there are must be as many.
    file.document["meshes"][0]["primitives"].erase(1);
    file.document["accessors"][5] = {{"componentType", 5126}, {"type", "VEC3"}, {"count", 0}};
    file.primitive()["attributes"]["NORMAL"] = 5;
    EXPECT_THROW((void)file.load(), InputError);
}

TEST(gltf_mend, animation_channels_of_no_keyframes) {
    GltfTest file;
    const int no_times = file.add_floats({0}, "SCALAR", 0);
    const int nothing = file.add_floats({0}, "VEC3", 0);
    const int times = file.add_floats({0, 1}, "SCALAR", 2);
    const int moves = file.add_floats({5, 0, 0, 7, 0, 0}, "VEC3", 2);
    const json pointer = {
        {"path", "pointer"},
        {"extensions", {{"KHR_animation_pointer", {{"pointer", "/nodes/0/translation"}}}}}};
    const json path = {{"node", 0}, {"path", "translation"}};
    const auto expect_place = [&](int input, int output, const json& target, glm::vec3 place) {
        file.document["animations"] = {{{"samplers", {{{"input", input}, {"output", output}}}},
                                        {"channels", {{{"sampler", 0}, {"target", target}}}}}};
        const Scene scene = file.load(0.5);
        expect_near(triangle(scene, 0)[0], place);
        expect_one_warning(scene, {"accessors[5].count", "1 more", "animation channels"});
    };
    for (const json& target : {path, pointer}) {
        expect_place(no_times, nothing, target, {0, 0, 0});
        expect_place(times, nothing, target, {0, 0, 0});
        expect_place(no_times, moves, target, {0, 0, 0});
        expect_place(times, moves, target, {6, 0, 0});
    }
}

TEST(gltf_mend, instances_of_no_number) {
    GltfTest file;
    file.document["extensionsUsed"] = {"EXT_mesh_gpu_instancing"};
    file.document["accessors"].push_back({{"componentType", 5126}, {"type", "VEC3"}, {"count", 0}});
    file.document["accessors"].push_back({{"componentType", 5126}, {"type", "VEC3"}, {"count", 2}});
    json& node = file.document["nodes"][0];
    json& attributes = node["extensions"]["EXT_mesh_gpu_instancing"]["attributes"];
    attributes = {{"TRANSLATION", 5}};
    const Scene scene = file.load();
    EXPECT_EQ(scene.seen_triangle_count(), 0u);
    expect_one_warning(scene, {"accessors[5].count", "instances"});
    for (const auto& [translation, scale] : {std::pair{5, 6}, {6, 5}}) {
        attributes = {{"TRANSLATION", translation}, {"SCALE", scale}};
        EXPECT_THROW((void)file.load(), InputError) << translation;
    }
}

TEST(gltf_mend, coordinates_of_no_accessor) {
    GltfTest file = textured();
    file.document["images"] = {{{"uri", write_texel("texel.png", {255, 0, 0, 255})}}};
    json& texture = file.document["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"];
    texture = {{"index", 0}};
    file.primitive()["attributes"]["TEXCOORD_1"] = 99;
    expect_one_warning(file.load(),
                       {"meshes[0].primitives[0].attributes.TEXCOORD_1", "is no accessor"});
    texture["texCoord"] = 1;  // as where the attribute is absent
    const Scene scene = file.load();
    EXPECT_EQ(scene.warnings.size(), 2u);
    for (const glm::vec2& uv : scene.coordinates[0]) EXPECT_EQ(uv, glm::vec2(0));
    file.primitive()["attributes"]["NORMAL"] = 99;
    EXPECT_THROW((void)file.load(), InputError);
}

// A chunk's length says where the next one starts, whatever it is, or where its padding does.
TEST(gltf_mend, chunks_that_are_not_padded) {
    GltfTest file;
    file.document["buffers"][0].erase("uri");
    std::ifstream stream(test::temporary("data.bin"), std::ios::binary);
    std::string data((std::istreambuf_iterator<char>(stream)), {});
    for (const auto& [rest, pads] : {std::pair<std::size_t, bool>{0, false},
                                     {1, false},
                                     {2, false},
                                     {3, false},
                                     {1, true},
                                     {2, true},
                                     {3, true}}) {
        std::string text = file.document.dump();
        text.resize((text.size() + 3) / 4 * 4 + rest, ' ');
        const std::string binary = data + std::string(rest, '\0');
        std::string glb = "glTF";
        const auto add = [&glb](std::size_t value) {
            const auto v = static_cast<std::uint32_t>(value);
            glb.append(reinterpret_cast<const char*>(&v), 4);
        };
        add(2);
        const std::string padding(pads ? 4 - rest : 0, ' ');
        add(28 + text.size() + binary.size() + 2 * padding.size());
        add(text.size());
        add(0x4e4f534a);
        glb += text + padding;
        add(binary.size());
        add(0x004e4942);
        glb += binary + padding;
        const std::string path = test::temporary("unpadded.glb");
        std::ofstream(path, std::ios::binary) << glb;
        const Scene scene = load_scene(path);
        expect_near(triangle(scene, 0)[2], {0, 1, 0});
        if (rest == 0)
            EXPECT_TRUE(scene.warnings.empty());
        else
            expect_one_warning(scene, {"glb chunk 0", "1 more", "multiple of 4"});
    }
}

// Where a normal or tangent is none, the surface is flat; positions must be numbers.
TEST(gltf_mend, normals_that_are_no_numbers) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const float inf = std::numeric_limits<float>::infinity();
    GltfTest file;
    file.primitive()["attributes"]["NORMAL"] =
        file.add_floats({0, 0, 1, nan, nan, nan, 0, inf, 1}, "VEC3", 3);
    const Scene scene = file.load();
    EXPECT_EQ(scene.vertex_normals[0], glm::vec3(0, 0, 1));
    EXPECT_EQ(scene.vertex_normals[1], glm::vec3(0));
    EXPECT_EQ(scene.vertex_normals[2], glm::vec3(0));
    expect_one_warning(scene, {"meshes[0].primitives[0].attributes.NORMAL", "not finite"});
    file.primitive()["attributes"]["POSITION"] = file.primitive()["attributes"]["NORMAL"];
    EXPECT_THROW((void)file.load(), InputError);
}

TEST(gltf_mend, texture_coordinates_that_are_absent) {
    GltfTest file = textured();
    file.document["images"] = {{{"uri", write_texel("texel.png", {255, 0, 0, 255})}}};
    file.document["materials"] = {
        {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}, {"texCoord", 3}}}}}}};
    const Scene scene = file.load();
    ASSERT_EQ(scene.coordinates.size(), 1u);
    for (const glm::vec2& uv : scene.coordinates[0]) EXPECT_EQ(uv, glm::vec2(0));
    expect_one_warning(scene, {"meshes[0].primitives[0]", "TEXCOORD_3"});
    // A triangle that shines: its light is the texel's.
    file.document["materials"] = {
        {{"emissiveFactor", {1, 1, 1}}, {"emissiveTexture", {{"index", 0}, {"texCoord", 3}}}}};
    Scene lit = file.load();
    add_emitters(lit, 0);
    ASSERT_FALSE(lit.lights.empty());
    for (const Light& light : lit.lights) expect_near(glm::vec3(light.emission), {1, 0, 0});
}

// What is missing shows nothing: no metal, no light, otherwise the material's factors.
TEST(gltf_mend, textures_without_an_image) {
    GltfTest file = textured();
    file.document["materials"] = {{{"pbrMetallicRoughness",
                                    {{"baseColorFactor", {0.2, 0.4, 0.6, 1}},
                                     {"baseColorTexture", {{"index", 0}}},
                                     {"roughnessFactor", 0.5},
                                     {"metallicRoughnessTexture", {{"index", 0}}}}},
                                   {"normalTexture", {{"index", 0}}},
                                   {"emissiveFactor", {1, 1, 1}},
                                   {"emissiveTexture", {{"index", 0}}}}};
    const auto expect_factors = [&](std::initializer_list<const char*> words) {
        const Scene scene = file.load();
        const Material& m = material_of(scene, 0);
        EXPECT_EQ(m.base_color, float4(0.2f, 0.4f, 0.6f, 0));
        EXPECT_EQ(m.roughness, 0.25f);
        EXPECT_EQ(glm::vec3(m.emission), glm::vec3(0));
        EXPECT_TRUE(scene.maps.empty());
        expect_one_warning(scene, words);
    };
    file.document["images"] = {{{"uri", "none.png"}}};
    expect_factors({"images[0].uri", "none.png", "no file"});
    file.document["images"] = {json::object()};
    expect_factors({"images[0]", "no image"});
    file.document["textures"][0].erase("source");
    expect_factors({"textures[0]", "no image"});
    // Beside one that is there.
    file.document["textures"] = {{{"source", 0}}, {{"source", 1}}};
    file.document["images"] = {{{"uri", "none.png"}},
                               {{"uri", write_texel("there.png", {255, 255, 255, 255})}}};
    file.document["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["index"] = 1;
    const Scene scene = file.load();
    EXPECT_TRUE(has_map(scene, 0, MAP_BASE_COLOR));
    EXPECT_FALSE(has_map(scene, 0, MAP_EMISSION));
    // A texture that is used must name an image; others need not.
    file.document["textures"].push_back({{"source", 7}});
    EXPECT_EQ(file.load().warnings.size(), 2u);
    file.document["materials"][0]["normalTexture"]["index"] = 2;
    EXPECT_THROW((void)file.load(), InputError);
}

TEST(gltf_mend, textures_that_nothing_uses_need_no_image) {
    GltfTest file;
    file.document["textures"] = {{{"source", 0}}};
    const Scene scene = file.load();
    EXPECT_EQ(scene.triangle_count(), 1u);
    expect_one_warning(scene, {"textures[0].source", "nothing that is rendered"});
}

// A scale of 0 hides what is at a node.
TEST(gltf_mend, nodes_scaled_to_0) {
    GltfTest file;
    file.document["extensions"]["KHR_lights_punctual"]["lights"] = {
        {{"type", "point"}},
        {{"type", "spot"}, {"spot", json::object()}},
        {{"type", "directional"}}};
    const auto node = [&](int light, const json& scale) {
        return json{{"scale", scale},
                    {"extensions", {{"KHR_lights_punctual", {{"light", light}}}}}};
    };
    const json zero = {0, 0, 0};
    file.document["cameras"] = {
        {{"type", "perspective"}, {"perspective", {{"yfov", 1.0}, {"znear", 0.1}}}}};
    file.document["nodes"] = {{{"mesh", 0}},     node(0, zero),      node(1, zero),
                              node(2, zero),     node(1, {1, 1, 0}), node(1, {0, 0, 1}),
                              node(0, {1, 1, 0})};
    file.document["scenes"][0]["nodes"] = {0, 1, 2, 3, 4, 5, 6};
    Scene scene = file.load();
    EXPECT_EQ(scene.lights.size(), 2u);  // the spot that keeps its direction, and a point
    expect_one_warning(scene, {"nodes[1]", "3 more", "light is hidden"});
    file.document["nodes"] = {{{"mesh", 0}},
                              {{"camera", 0}, {"name", "hidden"}, {"scale", zero}},
                              {{"camera", 0}, {"name", "seen"}}};
    file.document["scenes"][0]["nodes"] = {0, 1, 2};
    scene = file.load();
    ASSERT_EQ(scene.views.size(), 1u);
    EXPECT_EQ(scene.views[0].name, "seen");
    expect_one_warning(scene, {"nodes[1]", "camera"});
}

TEST(gltf_mend, mirrored_cameras) {
    GltfTest file;
    const auto camera = [&](double xmag, double ymag) {
        file.document["cameras"] = {
            {{"type", "orthographic"},
             {"orthographic", {{"xmag", xmag}, {"ymag", ymag}, {"znear", 0}, {"zfar", 9}}}}};
        file.document["nodes"] = {{{"mesh", 0}}, {{"camera", 0}}};
        file.document["scenes"][0]["nodes"] = {0, 1};
        const Scene scene = file.load();
        if (xmag < 0 || ymag < 0) expect_one_warning(scene, {"cameras[0]", "mirrored"});
        EXPECT_EQ(scene.views[0].aspect, 2);
        return make_camera(scene.views[0], 200, 100);
    };
    expect_near(camera(3, 1.5).right, {3, 0, 0});
    expect_near(camera(-3, 1.5).right, {-3, 0, 0});
    expect_near(camera(-3, 1.5).up, {0, 1.5f, 0});
    expect_near(camera(3, -1.5).up, {0, -1.5f, 0});
    expect_near(camera(-3, -1.5).forward, {0, 0, -1});
}

// KHR_materials_variants.
TEST(gltf_mend, variants) {
    GltfTest file;
    file.document["extensionsUsed"] = {"KHR_materials_variants"};
    file.document["extensionsRequired"] = {"KHR_materials_variants"};
    file.document["materials"] = {{{"name", "plain"}}, {{"name", "red"}}, {{"name", "blue"}}};
    file.document["extensions"]["KHR_materials_variants"]["variants"] = {
        {{"name", "Red"}}, {{"name", "Blue"}}, {{"name", "Sky"}}, {{"name", "None"}}};
    file.primitive()["material"] = 0;
    file.primitive()["extensions"]["KHR_materials_variants"]["mappings"] = {
        {{"material", 1}, {"variants", {0}}}, {{"material", 2}, {"variants", {1, 2}}}};
    const auto shown = [&](const std::string& variant) {
        const Scene scene = file.load({.variant = variant});
        EXPECT_TRUE(scene.warnings.empty());
        return scene.material_names[scene.triangle_materials[0]];
    };
    EXPECT_EQ(shown(""), "plain");
    EXPECT_EQ(shown("Red"), "red");
    EXPECT_EQ(shown("Blue"), "blue");
    EXPECT_EQ(shown("Sky"), "blue");
    EXPECT_EQ(shown("None"), "plain");
    try {
        (void)shown("Green");
        ADD_FAILURE();
    } catch (const InputError& error) {
        for (const char* word : {"--variant Green", "'Red', 'Blue', 'Sky', 'None'"})
            EXPECT_NE(std::string(error.what()).find(word), std::string::npos) << error.what();
    }
    file.primitive()["extensions"]["KHR_materials_variants"]["mappings"][0]["variants"] = {4};
    EXPECT_THROW((void)file.load(), InputError);
}

// KHR_node_visibility: meshes and lights of a node and of all below it; cameras stay.
TEST(gltf_mend, nodes_that_are_not_visible) {
    GltfTest file;
    file.document["extensionsUsed"] = {"KHR_node_visibility", "KHR_lights_punctual"};
    file.document["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}}};
    file.document["cameras"] = {
        {{"type", "perspective"}, {"perspective", {{"yfov", 1.0}, {"znear", 0.1}}}}};
    const json light = {{"KHR_lights_punctual", {{"light", 0}}}};
    file.document["nodes"] = {
        {{"mesh", 0}, {"extensions", {{"KHR_node_visibility", {{"visible", true}}}}}},
        {{"mesh", 0},
         {"children", {2, 3}},
         {"extensions", {{"KHR_node_visibility", {{"visible", false}}}}}},
        {{"mesh", 0}, {"extensions", {{"KHR_node_visibility", {{"visible", true}}}}}},
        {{"extensions", light}, {"children", {4}}},
        {{"camera", 0}},
        {{"extensions", light}}};
    file.document["scenes"][0]["nodes"] = {0, 1, 5};
    const Scene scene = file.load();
    EXPECT_EQ(scene.triangle_count(), 1u);
    EXPECT_EQ(scene.lights.size(), 1u);
    EXPECT_EQ(scene.views.size(), 1u);
    EXPECT_TRUE(scene.warnings.empty());
}

// KHR_materials_pbrSpecularGlossiness: the specular colour is the reflectance of no metal.
TEST(gltf_mend, specular_and_glossiness) {
    GltfTest file = textured();
    file.document["extensionsUsed"] = {"KHR_materials_pbrSpecularGlossiness"};
    file.document["extensionsRequired"] = {"KHR_materials_pbrSpecularGlossiness"};
    json& in = file.document["materials"][0]["extensions"]["KHR_materials_pbrSpecularGlossiness"];
    in = {{"diffuseFactor", {0.1, 0.2, 0.3, 1}},
          {"specularFactor", {0.9, 0.5, 0.04}},
          {"glossinessFactor", 0.75}};
    file.document["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"] = {1, 1, 1, 1};
    Scene scene = file.load();
    EXPECT_TRUE(scene.warnings.empty() ||
                scene.warnings[0].find("textures[0]") != std::string::npos);
    Material m = material_of(scene, 0);
    EXPECT_EQ(m.base_color, float4(0.1f, 0.2f, 0.3f, 0));
    EXPECT_NEAR(m.roughness, 0.0625f, 1e-6);
    EXPECT_EQ(m.specular, 1);
    expect_near(glm::vec3(m.reflectance), {0.9f, 0.5f, 0.04f});
    // Glossiness in A: 0.75 of 0.4 (102 / 255) is a roughness of 0.7.
    file.document["images"] = {{{"uri", write_texel("glossy.png", {255, 255, 0, 102})}}};
    in["specularGlossinessTexture"]["index"] = 0;
    in["diffuseTexture"]["index"] = 0;
    scene = file.load();
    m = material_of(scene, 0);
    EXPECT_EQ(m.roughness, 1);
    const auto texel = [&](MapKind kind) {
        EXPECT_TRUE(has_map(scene, 0, kind));
        const TextureMap& map = scene.maps[MAP_KIND_COUNT * scene.triangle_materials[0] + kind];
        return texel_of(scene, scene.textures[map.texture], 0, 0, 0);
    };
    EXPECT_NEAR(texel(MAP_METALLIC_ROUGHNESS).y, 0.7f, 0.003);
    EXPECT_EQ(texel(MAP_METALLIC_ROUGHNESS).z, 0);
    expect_near(glm::vec3(texel(MAP_SPECULAR_COLOR)), {1, 1, 0});
    expect_near(glm::vec3(texel(MAP_BASE_COLOR)), {1, 1, 0});
    // By default a mirror of white.
    in = json::object();
    scene = file.load();
    m = material_of(scene, 0);
    EXPECT_EQ(m.base_color, float4(1, 1, 1, 0));
    expect_near(glm::vec3(m.reflectance), {1, 1, 1});
    EXPECT_EQ(m.roughness, SMALLEST_ALPHA);
    in["glossinessFactor"] = 2;
    EXPECT_THROW((void)file.load(), InputError);
}

// What only decorates a material refuses no file; what shows nothing is not worth a word.
TEST(gltf_mend, required_extensions) {
    GltfTest file;
    const auto require = [&](const char* name) {
        file.document["extensionsUsed"] = {name};
        file.document["extensionsRequired"] = {name};
        return file.load();
    };
    for (const char* name : {"KHR_materials_transmission", "KHR_materials_clearcoat",
                             "ADOBE_materials_thin_transparency"})
        expect_one_warning(require(name), {name, "not rendered"});
    for (const char* name : {"EXT_structural_metadata", "EXT_mesh_features", "KHR_xmp_json_ld"})
        EXPECT_TRUE(require(name).warnings.empty()) << name;
    for (const char* name : {"VENDOR_voxels", "KHR_texture_basisu"})
        EXPECT_THROW((void)require(name), InputError) << name;
}

}  // namespace manylight

// SPDX-License-Identifier: MIT
// Textures, vertex colours and alpha. Refusals are in malformed.py.
#include "scene/textures.hpp"

#include <OpenImageIO/imageio.h>

#include <cmath>
#include <fstream>

#include "reference/gbuffer.hpp"
#include "reference/textures.hpp"
#include "reference/tiles.hpp"
#include "scene/alpha.hpp"
#include "scene/gltf/load.hpp"
#include "support.hpp"

namespace manylight {
namespace {

using nlohmann::json;

const std::uint8_t red[] = {255, 0, 0, 255}, green[] = {0, 255, 0, 255}, blue[] = {0, 0, 255, 255},
                   grey[] = {188, 188, 188, 255};

// An image of texels in rows from the top.
DecodedImage image_of(unsigned width, const std::vector<const std::uint8_t*>& texels) {
    DecodedImage image;
    image.width = width;
    image.height = static_cast<unsigned>(texels.size()) / width;
    for (const std::uint8_t* texel : texels)
        image.bytes.insert(image.bytes.end(), texel, texel + 4);
    return image;
}

// The square from -1 to 1 in the plane z = 0 that faces +z, with (0, 0) at its upper left.
Scene square() {
    Scene scene;
    scene.file = "square";
    scene.vertices = {{-1, 1, 0}, {-1, -1, 0}, {1, -1, 0}, {1, 1, 0}};
    scene.coordinates = {{{0, 0}, {0, 1}, {1, 1}, {1, 0}}};
    scene.indices = {0, 1, 2, 0, 2, 3};
    scene.triangle_materials = {0, 0};
    Material material{};
    material.base_color = float4(1, 1, 1, 0);
    material.roughness = material.alpha = 1;
    scene.materials = {material};
    return scene;
}

// Gives the scene's material 0 a texture; nearest texels, repeated.
Texture& add_texture(Scene& scene, MapKind kind, const DecodedImage& image, bool color = true) {
    if (scene.maps.empty()) {
        TextureMap none{};
        none.texture = NO_TEXTURE;
        scene.maps.assign(MAP_KIND_COUNT * scene.materials.size(), none);
    }
    TextureMap& map = scene.maps[kind];
    map.u = float4(1, 0, 0, 0);
    map.v = float4(0, 1, 0, 0);
    map.scale = 1;
    map.texture = static_cast<uint>(scene.textures.size());
    scene.textures.push_back(add_texels(scene, image, {.color = color}, "test"));
    return scene.textures.back();
}

// Orthographic, looking along -z at the square, `half` m high to both sides.
Camera camera_on(double half, glm::dvec2 at = {0, 0}) {
    View view;
    view.orthographic = true;
    view.half_height = half;
    view.to_world[3] = glm::dvec4(at, 3, 1);
    return make_camera(view, 64, 64);
}

struct Traced {
    std::vector<Surface> surfaces;
    std::vector<Material> materials;
    Tiles tiles;
    [[nodiscard]] const Surface& surface(uint x, uint y) const {
        return surfaces[reference::item_of(tiles, x, y)];
    }
    [[nodiscard]] const Material& at(uint x, uint y) const {
        return materials[surface(x, y).shading];
    }
};

Traced trace(Device device, const Scene& scene, const Camera& camera, uint seed = 0) {
    const Tiles tiles = all_tiles(64, 64, 32);
    const WideBvh bvh = build_wide_bvh(scene, 8, 8, reach_of(scene, camera));
    const DeviceScene uploaded =
        upload_scene(device, scene, bvh, camera, nullptr, item_count(tiles));
    Buffer<Surface> surfaces = device.allocate<Surface>(item_count(tiles));
    GBufferStage(device, uploaded).trace(tiles, {0, seed, false}, surfaces);
    return {surfaces.download(), uploaded.materials.download(), tiles};
}

void expect_color(const Material& material, glm::vec3 color, float tolerance = 1e-5f) {
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(material.base_color[c], color[c], tolerance);
}

// Adds an opaque blue square a unit behind the scene's, and the sun behind the camera: what it sees
// of the back is lit through the front.
void add_blue_behind(Scene& scene) {
    Material behind = scene.materials[0];
    behind.base_color = float4(0, 0, 1, 0);
    behind.cutoff = 0;
    behind.alpha = 1;
    scene.materials.push_back(behind);
    if (!scene.maps.empty())
        scene.maps.resize(MAP_KIND_COUNT * 2, {float4(0), float4(0), NO_TEXTURE, 0, 0, 0});
    for (std::uint32_t k = 0; k < 4; ++k) {
        scene.vertices.push_back(scene.vertices[k] - glm::vec3(0, 0, 1));
        scene.coordinates[0].push_back(scene.coordinates[0][k]);
    }
    for (const std::uint32_t k : {4, 5, 6, 4, 6, 7}) scene.indices.push_back(k);
    scene.triangle_materials.insert(scene.triangle_materials.end(), {1, 1});
    find_alpha(scene);
    Light sun{};
    sun.position.w = LIGHT_DIRECTIONAL;
    sun.axis = float4(0, 0, -1, 0);
    sun.emission = float4(1, 1, 1, 0);
    scene.lights = {sun};
    add_emitters(scene, 0);
}

}  // namespace

// Which texel is where; 188 encodes 0.5029 (IEC 61966-2-1).
TEST(textures, texels_by_hand) {
    Scene scene = square();
    add_texture(scene, MAP_BASE_COLOR, image_of(2, {red, green, blue, grey}));
    FOR_EACH_DEVICE(device) {
        const Traced found = trace(device, scene, camera_on(1));
        expect_color(found.at(10, 10), {1, 0, 0});
        expect_color(found.at(50, 10), {0, 1, 0});
        expect_color(found.at(10, 50), {0, 0, 1});
        expect_color(found.at(50, 50), glm::vec3(0.50289f));
        EXPECT_EQ(found.surface(50, 50).material, 0u);
    }
}

// Beyond the image, to the right of it: (u, v) from (1, 0).
TEST(textures, wrap_modes) {
    Scene scene = square();
    Texture& texture = add_texture(scene, MAP_BASE_COLOR, image_of(2, {red, green}));
    scene.maps[MAP_BASE_COLOR].u.z = 1;
    const std::pair<uint, std::array<glm::vec3, 2>> cases[] = {
        {WRAP_REPEAT, {glm::vec3(1, 0, 0), {0, 1, 0}}},
        {WRAP_MIRROR, {glm::vec3(0, 1, 0), {1, 0, 0}}},
        {WRAP_CLAMP, {glm::vec3(0, 1, 0), {0, 1, 0}}}};
    FOR_EACH_DEVICE(device)
    for (const auto& [wrap, colors] : cases) {
        texture.wrap_u = wrap;
        const Traced found = trace(device, scene, camera_on(1));
        expect_color(found.at(10, 30), colors[0]);
        expect_color(found.at(50, 30), colors[1]);
    }
}

// Half way between the centres of two texels, and at one of them.
TEST(textures, interpolated_texels) {
    Scene scene = square();
    Texture& texture = add_texture(scene, MAP_BASE_COLOR, image_of(2, {red, green}));
    texture.magnified_linear = 1;
    texture.wrap_u = WRAP_CLAMP;
    const double pixel = 1.0 / 64;
    FOR_EACH_DEVICE(device) {
        expect_color(trace(device, scene, camera_on(1, {pixel, 0})).at(31, 31), {0.5f, 0.5f, 0});
        expect_color(trace(device, scene, camera_on(1, {pixel, 0})).at(15, 31), {1, 0, 0});
        expect_color(trace(device, scene, camera_on(1, {pixel, 0})).at(5, 31), {1, 0, 0});
    }
}

// A pixel that sees a quarter of the image, all of it, and more.
TEST(textures, levels_by_the_area_seen) {
    Scene scene = square();
    std::vector<const std::uint8_t*> texels;
    for (int i = 0; i < 64; ++i) texels.push_back(i % 2 == i / 8 % 2 ? red : grey);
    Texture& texture = add_texture(scene, MAP_BASE_COLOR, image_of(8, texels));
    EXPECT_EQ(texture.levels, 4u);
    texture.minified_linear = 1;
    const glm::vec3 mean(0.75144f, 0.25144f, 0.25144f);  // of red and grey, linear
    FOR_EACH_DEVICE(device)
    for (const uint between : {LEVELS_NEAREST, LEVELS_BLENDED})
        for (const double texels_per_pixel : {2.0, 8.0, 100.0}) {
            texture.between = between;
            // The square's 8 texels are 0.25 m; pixel (31, 31) is in its middle.
            const double pixel = 0.25 * texels_per_pixel;
            const Camera camera = camera_on(32 * pixel, glm::dvec2(pixel / 2 + 0.01, -pixel / 2));
            expect_color(trace(device, scene, camera).at(31, 31), mean, 0.004f);
        }
    texture.between = LEVELS_FINEST;
    texture.minified_linear = 0;
    for (Device device : test::devices()) {
        const glm::vec3 color(
            trace(device, scene, camera_on(8, {0.01, 0.01})).at(31, 31).base_color);
        EXPECT_TRUE(color.g < 0.01f || color.r < 0.6f) << "one texel";
    }
}

// Levels of an image whose sides are no powers of two keep its mean.
TEST(textures, odd_sides_keep_the_mean) {
    Scene scene = square();
    DecodedImage image;
    image.width = 7;
    image.height = 3;
    double sum = 0;
    for (unsigned i = 0; i < 21; ++i) {
        const float value = 0.01f * static_cast<float>((i * 37) % 23);
        sum += value;
        for (int c = 0; c < 3; ++c) image.floats.push_back(value);
        image.floats.push_back(1);
    }
    image.linear = true;
    const Texture texture = add_texels(scene, image, {.color = true}, "test");
    ASSERT_EQ(texture.levels, 3u);
    EXPECT_NEAR(texel_of(scene, texture, 2, 0, 0).r, sum / 21, 2e-4);
}

// Colours do not bleed from texels that are not there.
TEST(textures, levels_by_alpha) {
    const std::uint8_t nothing[] = {0, 255, 0, 0};
    Scene scene = square();
    const Texture texture =
        add_texels(scene, image_of(2, {red, nothing}), {.color = true, .weighted = true}, "test");
    const glm::vec4 texel = texel_of(scene, texture, 1, 0, 0);
    EXPECT_NEAR(texel.r, 1, 1e-6);
    EXPECT_NEAR(texel.g, 0, 1e-6);
    EXPECT_NEAR(texel.a, 0.5, 0.005);
}

TEST(textures, vertex_colors) {
    Scene scene = square();
    scene.colors = {{1, 0, 0, 1}, {0, 0, 1, 1}, {0, 0, 1, 1}, {1, 0, 0, 1}};
    FOR_EACH_DEVICE(device) {
        const Traced found = trace(device, scene, camera_on(1));
        expect_color(found.at(20, 31), {0.5f + 0.5f / 64, 0, 0.5f - 0.5f / 64});
    }
}

// Metallic in blue and roughness in green, linear; emission as a colour.
TEST(textures, other_maps) {
    Scene scene = square();
    scene.materials[0].base_color.w = 0.5f;
    scene.materials[0].roughness = 0.64f;
    scene.materials[0].emission = float4(2, 2, 2, 0);
    const std::uint8_t half[] = {9, 128, 64, 255};
    add_texture(scene, MAP_METALLIC_ROUGHNESS, image_of(1, {half}), false);
    add_texture(scene, MAP_EMISSION, image_of(1, {grey}));
    FOR_EACH_DEVICE(device) {
        const Material m = trace(device, scene, camera_on(1)).at(20, 31);
        EXPECT_NEAR(m.base_color.w, 0.5 * 64 / 255, 1e-6);
        EXPECT_NEAR(m.roughness, std::pow(0.8 * 128 / 255, 2), 1e-6);
        EXPECT_NEAR(m.emission.y, 2 * 0.50289, 1e-5);
    }
}

// A normal that leans to the image's right by 3 of 5 and one that leans up, seen from both sides.
TEST(textures, normals_by_hand) {
    const std::uint8_t right[] = {204, 128, 230, 255}, up[] = {128, 204, 230, 255};
    const auto component = [](int byte) { return 2.0 * byte / 255 - 1; };
    const double length = std::hypot(component(204), component(128), component(230));
    for (const bool from_tangents : {false, true}) {
        Scene scene = square();
        if (from_tangents) scene.tangents.assign(4, {1, 0, 0, 1});
        add_texture(scene, MAP_NORMAL, image_of(2, {right, up}), false);
        FOR_EACH_DEVICE(device) {
            const Traced found = trace(device, scene, camera_on(1));
            const float4 first = found.surface(10, 31).normal;
            const float4 second = found.surface(50, 31).normal;
            EXPECT_NEAR(first.x, component(204) / length, 1e-5);
            EXPECT_NEAR(first.z, component(230) / length, 1e-5);
            EXPECT_NEAR(second.y, component(204) / length, 1e-5);
            // From behind, x is mirrored in the image.
            View view;
            view.orthographic = true;
            view.half_height = 1;
            view.to_world[0] = {-1, 0, 0, 0};
            view.to_world[2] = {0, 0, -1, 0};
            view.to_world[3] = {0, 0, -3, 1};
            const Traced behind = trace(device, scene, make_camera(view, 64, 64));
            EXPECT_NEAR(behind.surface(50, 31).normal.x, -component(204) / length, 1e-5);
            EXPECT_NEAR(behind.surface(50, 31).normal.z, -component(230) / length, 1e-5);
        }
    }
}

namespace {

// A triangle that fills the view, with texture coordinates and an image to be added.
class TexturedFile {
  public:
    json document;

    TexturedFile() {
        const float positions[] = {-9, -9, 0, 9, -9, 0, 0, 9, 0};
        const float coordinates[] = {0.25f, 0.25f, 0.25f, 0.25f, 0.25f, 0.25f};
        const std::uint16_t fractions[] = {49151, 16384, 49151, 16384, 49151, 16384};
        const std::uint8_t colors[] = {255, 51, 0, 0, 255, 51, 0, 0, 255, 51, 0, 0};
        std::string data;
        const auto add = [&](const auto& array) {
            document["bufferViews"].push_back(
                {{"buffer", 0}, {"byteOffset", data.size()}, {"byteLength", sizeof(array)}});
            data.append(reinterpret_cast<const char*>(array), sizeof(array));
        };
        add(positions);
        add(coordinates);
        add(fractions);
        add(colors);
        document["bufferViews"][3]["byteStride"] = 4;
        std::ofstream(test::temporary("data.bin"), std::ios::binary) << data;
        document["asset"] = {{"version", "2.0"}};
        document["scene"] = 0;
        document["scenes"] = {{{"nodes", {0}}}};
        document["nodes"] = {{{"mesh", 0}}};
        document["meshes"] = {
            {{"primitives",
              {{{"attributes", {{"POSITION", 0}, {"TEXCOORD_0", 1}, {"TEXCOORD_1", 2}}},
                {"material", 0}}}}}};
        const auto accessor = [](int view, int type, const char* shape, bool fraction) {
            return json{{"bufferView", view},
                        {"componentType", type},
                        {"count", 3},
                        {"type", shape},
                        {"normalized", fraction}};
        };
        document["accessors"] = {accessor(0, 5126, "VEC3", false), accessor(1, 5126, "VEC2", false),
                                 accessor(2, 5123, "VEC2", true), accessor(3, 5121, "VEC3", true)};
        document["buffers"] = {{{"byteLength", data.size()}, {"uri", "data.bin"}}};
        document["materials"] = {
            {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
        document["textures"] = {{{"source", 0}}};
    }

    json& base_color() {
        return document["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"];
    }

    [[nodiscard]] Scene load(std::size_t most_bytes = 0) const {
        const std::string path = test::temporary("textured.gltf");
        std::ofstream(path) << document;
        return load_scene(path, {.most_bytes = most_bytes});
    }

    // The material where the camera looks.
    [[nodiscard]] Material material() const {
        const Scene scene = load();
        const reference::Ray ray{{0, 0, 3}, {0, 0, -1}};
        const auto hit = reference::Tracer(scene).closest_hit(ray);
        return reference::material_at(scene, ray, *hit);
    }
    [[nodiscard]] glm::vec3 color() const { return glm::vec3(material().base_color); }
};

// Two rows, red and green over blue and grey, 8 x 8 texels each.
std::string write_image(const std::string& name) {
    const std::string path = test::temporary(name);
    const auto out = OIIO::ImageOutput::create(path);
    OIIO::ImageSpec spec(16, 16, 3, OIIO::TypeDesc::UINT8);
    if (name.ends_with(".exr")) spec.format = OIIO::TypeDesc::HALF;
    spec["CompressionQuality"] = 100;
    std::vector<float> values;
    for (int y = 0; y < 16; ++y)
        for (int x = 0; x < 16; ++x) {
            const std::uint8_t* texel = y < 8 ? (x < 8 ? red : green) : (x < 8 ? blue : grey);
            for (int c = 0; c < 3; ++c) values.push_back(static_cast<float>(texel[c]) / 255);
        }
    EXPECT_TRUE(out->open(path, spec) && out->write_image(OIIO::TypeDesc::FLOAT, values.data()) &&
                out->close());
    return path;
}

std::string base64(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    const std::string bytes((std::istreambuf_iterator<char>(file)), {});
    static const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        std::uint32_t bits = 0;
        for (std::size_t k = 0; k < 3; ++k)
            bits = bits << 8 | (i + k < bytes.size() ? static_cast<std::uint8_t>(bytes[i + k]) : 0);
        for (std::size_t k = 0; k < 4; ++k)
            text += i + k > bytes.size() ? '=' : digits[bits >> (18 - 6 * k) & 63];
    }
    return text;
}

void expect_near(glm::vec3 found, glm::vec3 expected, float tolerance = 1e-3f) {
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(found[c], expected[c], tolerance);
}

}  // namespace

// 16 x 16 texels of 4 bytes, and their levels; its triangle and place need 344 bytes.
TEST(textures, beyond_memory) {
    (void)write_image("large.png");
    TexturedFile file;
    file.document["images"] = {{{"uri", "large.png"}}};
    EXPECT_EQ(file.load(1800).texels.size(), 256u + 64 + 16 + 4 + 1);
    EXPECT_THROW((void)file.load(1600), InputError);
}

// The factor is in A, the colour in RGB; F0 is at most 1 after all factors.
TEST(textures, specular) {
    const std::string path = test::temporary("specular.png");
    const auto out = OIIO::ImageOutput::create(path);
    const std::uint8_t texel[] = {255, 188, 0, 102};
    OIIO::ImageSpec spec(1, 1, 4, OIIO::TypeDesc::UINT8);
    spec["oiio:UnassociatedAlpha"] = 1;
    EXPECT_TRUE(out->open(path, spec) && out->write_image(OIIO::TypeDesc::UINT8, texel) &&
                out->close());
    TexturedFile file;
    file.document["images"] = {{{"uri", "specular.png"}}};
    file.document["materials"] = {{{"extensions",
                                    {{"KHR_materials_specular",
                                      {{"specularFactor", 0.5},
                                       {"specularTexture", {{"index", 0}}},
                                       {"specularColorFactor", {100, 40, 1}},
                                       {"specularColorTexture", {{"index", 0}}}}}}}}};
    EXPECT_TRUE(file.load().warnings.empty());
    const Material material = file.material();
    EXPECT_NEAR(material.specular, 0.2f, 1e-6f);
    expect_near(glm::vec3(material.reflectance), {1, 0.8f, 0}, 0.01f);
}

// Every format, beside the file and as a data URI; a format is known by its bytes.
TEST(textures, image_files) {
    for (const std::string name : {"a b.png", "a.jpg", "a.webp", "a.exr"}) {
        SCOPED_TRACE(name);
        const std::string path = write_image(name);
        TexturedFile file;
        file.document["images"] = {{{"uri", name == "a b.png" ? "a%20b.png" : name}}};
        expect_near(file.color(), {1, 0, 0}, name == "a.jpg" ? 0.02f : 1e-3f);
        file.document["images"] = {{{"uri", "data:image/any;base64," + base64(path)}}};
        expect_near(file.color(), {1, 0, 0}, name == "a.jpg" ? 0.02f : 1e-3f);
    }
}

TEST(textures, coordinate_sets_and_transforms) {
    (void)write_image("b.png");
    TexturedFile file;
    file.document["images"] = {{{"uri", "b.png"}}};
    file.base_color()["texCoord"] = 1;  // (0.75, 0.25), of 16 bits
    expect_near(file.color(), {0, 1, 0});
    json& moved = file.base_color()["extensions"]["KHR_texture_transform"];
    moved["texCoord"] = 0;
    expect_near(file.color(), {1, 0, 0});
    moved["offset"] = {0.5, 0.5};
    expect_near(file.color(), glm::vec3(0.50289f));
    moved["offset"] = {0, 0};
    moved["scale"] = {1, 3};
    expect_near(file.color(), {0, 0, 1});
    // A quarter turn takes (0.25, 0.25) to (0.25, -0.25), which is repeated at (0.25, 0.75).
    moved["scale"] = {1, 1};
    moved["rotation"] = M_PI_2;
    expect_near(file.color(), {0, 0, 1});
}

TEST(textures, vertex_colors_of_bytes) {
    (void)write_image("c.png");
    TexturedFile file;
    file.document["images"] = {{{"uri", "c.png"}}};
    file.document["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = 3;
    file.base_color()["texCoord"] = 1;
    expect_near(file.color(), {0, 0.2f, 0});
    const Scene scene = file.load();
    EXPECT_TRUE(scene.warnings.empty());
    EXPECT_EQ(scene.colors[2], float4(1, 0.2f, 0, 1));
}

TEST(textures, samplers) {
    (void)write_image("d.png");
    TexturedFile file;
    file.document["images"] = {{{"uri", "d.png"}}};
    const Texture usual = file.load().textures[0];
    EXPECT_EQ(usual.wrap_u, WRAP_REPEAT);
    EXPECT_EQ(usual.magnified_linear, 1u);
    EXPECT_EQ(usual.minified_linear, 1u);
    EXPECT_EQ(usual.between, LEVELS_BLENDED);
    EXPECT_EQ(usual.levels, 5u);
    file.document["samplers"] = {
        {{"wrapS", 33071}, {"wrapT", 33648}, {"magFilter", 9728}, {"minFilter", 9984}}};
    file.document["textures"][0]["sampler"] = 0;
    const Texture other = file.load().textures[0];
    EXPECT_EQ(other.wrap_u, WRAP_CLAMP);
    EXPECT_EQ(other.wrap_v, WRAP_MIRROR);
    EXPECT_EQ(other.magnified_linear, 0u);
    EXPECT_EQ(other.minified_linear, 0u);
    EXPECT_EQ(other.between, LEVELS_NEAREST);
}

// Images that nothing shows are not read.
TEST(textures, unused_images) {
    TexturedFile file;
    file.document["images"] = {{{"uri", "none.png"}}};
    file.document["meshes"][0]["primitives"][0].erase("material");
    EXPECT_TRUE(file.load().texels.empty());
}

// All stages, on a scene with everything that varies materials, against the reference.
TEST(textures, agree_with_the_reference) {
    const test::TestScene base = test::make_scene(
        [](GltfWriter& out) {
            Mesh floor;
            floor.add_quad({-2, 0, 2}, {4, 0, 0}, {0, 0, -4});
            out.add_mesh("floor", floor, out.add_material({0.9f, 0.8f, 0.7f}, 0.8f, 0.7f));
            Mesh fence;
            fence.add_quad({-1, 0, 0.3f}, {2, 0, 0}, {0, 1, 0});
            out.add_mesh("fence", fence, out.add_diffuse({0.4f, 0.8f, 0.4f}));
            Mesh lamp;
            lamp.add_quad({-0.5f, 1.8f, -0.6f}, {1, 0, 0}, {0, 0, 1});
            out.add_mesh("lamp", lamp, out.add_emitter({6, 5, 4}));
            for (int i = 0; i < 3; ++i)
                out.add_point({static_cast<float>(i) - 1, 1.2f, 1.2f}, {0.5f, 0.6f, 0.4f});
            out.add_camera("front", {0.3f, 1.1f, 2.8f}, {0, 0.4f, 0}, 0.9f, 1.3f);
        },
        40, 30);
    Scene scene = base.scene;
    scene.lights.resize(3);
    scene.light_cells = {};
    std::vector<glm::vec2>& coordinates = scene.coordinates.emplace_back();
    for (const glm::vec3& v : scene.vertices) {
        coordinates.emplace_back(0.9f * v.x + 0.2f * v.z, 0.7f * v.z - v.y);
        scene.colors.emplace_back(1, 0.8f, 0.6f + 0.2f * v.x / 2, 1);
    }
    std::vector<const std::uint8_t*> texels;
    const std::uint8_t hole[] = {40, 200, 90, 0};
    for (int i = 0; i < 64; ++i) texels.push_back(i % 3 == 0 ? red : i % 5 < 2 ? hole : grey);
    const DecodedImage image = image_of(8, texels);
    const TextureMap none{float4(0), float4(0), NO_TEXTURE, 0, 0, 0};
    scene.maps.assign(MAP_KIND_COUNT * scene.materials.size(), none);
    const auto add = [&](std::uint32_t material, MapKind kind, bool color, uint between) {
        TextureMap& map = scene.maps[MAP_KIND_COUNT * material + kind];
        map = {float4(1, 0.2f, 0.3f, 0),
               float4(-0.2f, 1, 0, 0),
               static_cast<uint>(scene.textures.size()),
               0,
               0.7f,
               0};
        Texture texture = add_texels(scene, image, {.color = color}, "test");
        texture.magnified_linear = texture.minified_linear = 1;
        texture.between = between;
        texture.wrap_u = kind % 3;
        texture.wrap_v = (kind + 1) % 3;
        scene.textures.push_back(texture);
    };
    const std::uint32_t floor = scene.triangle_materials[0];
    const std::uint32_t fence = scene.triangle_materials[2];
    add(floor, MAP_BASE_COLOR, true, LEVELS_BLENDED);
    add(floor, MAP_METALLIC_ROUGHNESS, false, LEVELS_NEAREST);
    add(floor, MAP_NORMAL, false, LEVELS_BLENDED);
    add(floor, MAP_SPECULAR, false, LEVELS_BLENDED);
    add(floor, MAP_SPECULAR_COLOR, true, LEVELS_BLENDED);
    scene.materials[floor].specular = 0.9f;
    scene.materials[floor].reflectance = float4(0.05f, 4, 0.3f, 0);
    add(fence, MAP_BASE_COLOR, true, LEVELS_FINEST);
    add(scene.triangle_materials[4], MAP_EMISSION, true, LEVELS_BLENDED);
    scene.materials[fence].cutoff = 0.5f;
    scene.materials[fence].culled = 1;
    find_alpha(scene);
    ASSERT_EQ(scene.alpha_triangles.size(), 2u);
    add_emitters(scene, 0);
    FOR_EACH_DEVICE(device) {
        VerifyOptions options;
        options.width = base.width;
        options.height = base.height;
        options.most_entries = 8'000;
        Verifier verifier(device, scene, base.camera, options);
        for (const Check& check : verifier.all())
            if (check.tested()) test::expect_pass(check);
    }
}

// A square before another one, of which a half shows its back and is not seen: rays from the square
// behind meet that half's front, and the back of the other one. Primary rays one by one, and in
// packets.
TEST(textures, culled_in_every_ray) {
    Scene scene = square();
    scene.materials[0].culled = 1;
    std::swap(scene.indices[1], scene.indices[2]);
    add_blue_behind(scene);
    scene.materials[1].culled = 0;
    find_alpha(scene);
    ASSERT_EQ(scene.alpha_triangles.size(), 2u);
    Scene tilted = scene;
    tilted.lights[0].axis = float4(glm::normalize(glm::vec3(-1)), 0);
    View perspective;
    perspective.half_height = 1 / 3.;
    perspective.to_world[3] = glm::dvec4(0, 0, 3, 1);
    FOR_EACH_DEVICE(device)
    for (const Camera& camera : {camera_on(1), make_camera(perspective, 64, 64)}) {
        RenderOptions options;
        options.sampler = "exhaustive";
        options.spp = 1;
        const float lit = 1 / static_cast<float>(M_PI);
        const auto color = [&](const Scene& seen, unsigned x, unsigned y) {
            const Image image = test::render(device, {seen, camera, 64, 64}, options).image;
            return glm::vec3(image.at(x, y)[0], image.at(x, y)[1], image.at(x, y)[2]);
        };
        expect_near(color(scene, 50, 20), glm::vec3(lit));
        expect_near(color(scene, 20, 50), glm::vec3(0));
        expect_near(color(tilted, 20, 50), {0, 0, lit / std::sqrt(3.f)});
    }
}

// A masked square before another one: its holes show what is behind, and let light through.
TEST(textures, mask_in_every_ray) {
    const std::uint8_t hole[] = {255, 0, 0, 127}, whole[] = {255, 0, 0, 128};
    Scene scene = square();
    add_texture(scene, MAP_BASE_COLOR, image_of(2, {hole, whole}));
    scene.materials[0].cutoff = 0.5f;
    add_blue_behind(scene);
    ASSERT_EQ(scene.alpha_triangles.size(), 2u);
    const test::TestScene test{scene, camera_on(1), 64, 64};
    FOR_EACH_DEVICE(device) {
        RenderOptions options;
        options.sampler = "exhaustive";
        options.spp = 1;
        const Image image = test::render(device, test, options).image;
        const float lit = 1 / static_cast<float>(M_PI);
        expect_near({image.at(10, 30)[0], image.at(10, 30)[1], image.at(10, 30)[2]}, {0, 0, lit});
        expect_near({image.at(50, 30)[0], image.at(50, 30)[1], image.at(50, 30)[2]}, {lit, 0, 0});
        // Seen from the side, the sun shines on a part of the back only.
        Scene tilted = scene;
        tilted.lights[0].axis = float4(glm::normalize(glm::vec3(1, 0, -1)), 0);
        const test::TestScene other{tilted, camera_on(1), 64, 64};
        const Image side = test::render(device, other, options).image;
        expect_near({0, 0, side.at(5, 30)[2]}, {0, 0, lit * std::sqrt(0.5f)});
        expect_near({0, 0, side.at(27, 30)[2]}, {0, 0, lit * std::sqrt(0.5f)});
    }
}

// A surface that is there by 0.3 shows so much of itself and hides so much of a light, on average.
TEST(textures, blend_is_unbiased) {
    Scene scene = square();
    scene.materials[0].alpha = 0.3f;
    scene.materials[0].cutoff = -1;
    scene.materials[0].base_color = float4(1, 0, 0, 0);
    add_blue_behind(scene);
    const test::TestScene test{scene, camera_on(0.9), 64, 64};
    FOR_EACH_DEVICE(device)
    for (const bool pixel_centre : {false, true})
        for (const char* sampler : {"exhaustive", "adaptive"}) {
            RenderOptions options;
            options.sampler = sampler;
            options.spp = 16;
            options.seed = 3;
            options.pixel_centre = pixel_centre;
            const Image image = test::render(device, test, options).image;
            glm::dvec3 mean(0);
            for (std::size_t i = 0; i < image.values.size(); ++i)
                mean[static_cast<int>(i % 3)] += image.values[i] / (64.0 * 64.0);
            // 65,536 draws: the standard deviation of a share is 0.002.
            EXPECT_NEAR(mean.r * M_PI, 0.3, 0.01) << sampler;
            EXPECT_NEAR(mean.b * M_PI, 0.7 * 0.7, 0.01) << sampler;
            // No pixel is stuck: 16 samples give some of both nearly everywhere.
            int stuck = 0;
            for (std::size_t i = 0; i < image.values.size(); i += 3)
                stuck += image.values[i] == 0 || image.values[i + 2] == 0;
            EXPECT_LT(stuck, 64) << sampler;
        }
}

// An emitter whose texture is bright in a quarter: as bright as it, and its light comes from there.
TEST(textures, emitters_shine_where_their_texture_does) {
    const std::uint8_t black[] = {0, 0, 0, 255}, white[] = {255, 255, 255, 255};
    Scene scene = square();
    scene.materials[0].emission = float4(2, 2, 2, 0);
    add_texture(scene, MAP_EMISSION, image_of(2, {black, white, black, black}));
    add_emitters(scene, 0);
    double area = 0;
    ASSERT_FALSE(scene.lights.empty());
    for (const Light& light : scene.lights) {
        EXPECT_GE(light.position.x, -1e-5f);
        EXPECT_GE(light.position.y, -1e-5f);
        EXPECT_NEAR(light.emission.x, 2, 1e-5);
        area += glm::length(glm::cross(glm::vec3(light.axis), glm::vec3(light.edge)));
    }
    EXPECT_NEAR(area, 1, 1e-4);
    FOR_EACH_DEVICE(device) {
        const Traced found = trace(device, scene, camera_on(1));
        EXPECT_NEAR(found.at(50, 10).emission.x, 2, 1e-5);
        EXPECT_NEAR(found.at(10, 10).emission.x, 0, 1e-5);
    }
}

TEST(textures, memory_is_planned) {
    const Scene plain = square();
    Scene textured = plain;
    add_texture(textured, MAP_BASE_COLOR, image_of(2, {red, green, blue, grey}));
    const Device device = test::devices()[0];
    RenderOptions options;
    options.width = options.height = 64;
    const WideBvh bvh = build_wide_bvh(plain, 8, 8, 10);
    const Plan without = make_plan(device.info(), plain, bvh, options);
    const Plan with = make_plan(device.info(), textured, bvh, options);
    EXPECT_EQ(with.scene_bytes - without.scene_bytes,
              5 * 4 + sizeof(Texture) + MAP_KIND_COUNT * sizeof(TextureMap));
    EXPECT_GE(with.batch_bytes - without.batch_bytes, 64 * 64 * sizeof(Material));
}

}  // namespace manylight

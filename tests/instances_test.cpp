// SPDX-License-Identifier: MIT
// Meshes that are stored once and stand in several places: as if each place had a copy.
#include <OpenImageIO/imageio.h>

#include <fstream>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/type_ptr.hpp>
#include <random>

#include "bench/traversal.hpp"
#include "error.hpp"
#include "reference/tracing.hpp"
#include "reference/triangle.hpp"
#include "scene/alpha.hpp"
#include "scene/gltf/load.hpp"
#include "support.hpp"

namespace manylight {
namespace {

using nlohmann::json;

constexpr int side = 6;  // of the shell's squares

// A floor, an emissive square twice, lights, and a curved shell with holes and a normal map in
// places that turn, stretch and mirror it, far from its own frame's origin.
class InstancedFile {
  public:
    json document;

    InstancedFile() {
        OIIO::ImageSpec spec(16, 16, 3, OIIO::TypeDesc::UINT8);
        std::vector<std::uint8_t> texels;
        for (int i = 0; i < 256; ++i)
            for (const int v : {90 + 5 * (i % 16), 100 + 4 * (i / 16), 220})
                texels.push_back(static_cast<std::uint8_t>(v));
        const auto image = OIIO::ImageOutput::create(test::temporary("shell.png"));
        EXPECT_TRUE(image->open(test::temporary("shell.png"), spec) &&
                    image->write_image(OIIO::TypeDesc::UINT8, texels.data()) && image->close());
        document = {
            {"asset", {{"version", "2.0"}}},
            {"scene", 0},
            {"extensionsUsed", {"KHR_lights_punctual"}},
            {"extensions",
             {{"KHR_lights_punctual", {{"lights", {{{"type", "point"}, {"intensity", 4}}}}}}}},
            {"cameras",
             {{{"type", "perspective"}, {"perspective", {{"yfov", 0.9}, {"znear", 0.1}}}}}},
            {"images", {{{"uri", std::filesystem::path(test::temporary("shell.png")).filename()}}}},
            {"textures", {{{"source", 0}}}},
            {"materials",
             {{{"pbrMetallicRoughness", {{"metallicFactor", 0}}}},
              {{"pbrMetallicRoughness",
                {{"metallicFactor", 0},
                 {"roughnessFactor", 0.5},
                 {"baseColorTexture", {{"index", 0}}}}},
               {"normalTexture", {{"index", 0}}},
               {"alphaMode", "MASK"}},
              {{"pbrMetallicRoughness", {{"baseColorFactor", {0, 0, 0, 1}}, {"metallicFactor", 0}}},
               {"emissiveFactor", {1, 1, 1}}}}},
            {"nodes",
             {{{"mesh", 0}, {"scale", {4, 1, 4}}},
              {{"mesh", 2}, {"translation", {0, 3, 0}}, {"rotation", {1, 0, 0, 0}}},
              {{"mesh", 2}, {"translation", {2, 3, 0}}, {"rotation", {1, 0, 0, 0}}},
              {{"camera", 0}, {"translation", {0, 1.2, 4}}}}}};
        for (const json& mesh : {add_square(0), add_shell(), add_square(2)})
            document["meshes"].push_back(mesh);
        for (const glm::vec3 at : {glm::vec3(-1.5f, 2, 1), glm::vec3(1.5f, 2, 1.5f)})
            document["nodes"].push_back(
                {{"translation", {at.x, at.y, at.z}},
                 {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
        for (int i = 0; i < 5; ++i) add_place(place(i));
    }

    // Of the shell, which stands about (30, 0, 0) in its own frame.
    static glm::dmat4 place(int i) {
        glm::dmat4 m = glm::translate(glm::dmat4(1), {0.9 * i - 1.8, 0.6 + 0.2 * (i % 2), 0.3 * i});
        m = glm::rotate(m, 0.8 * i, glm::normalize(glm::dvec3(1, 2, 0.5)));
        m = glm::scale(m, glm::dvec3(i % 2 ? -1 : 1, 1 + 0.2 * i, i == 3 ? -0.7 : 0.8));
        return glm::translate(m, {-30, 0, 0});
    }

    void add_place(const glm::dmat4& to_world) {
        document["nodes"].push_back(
            {{"mesh", 1},
             {"matrix",
              std::vector<double>(glm::value_ptr(to_world), glm::value_ptr(to_world) + 16)}});
    }

    [[nodiscard]] Scene load(MeshStorage storage) { return load({.storage = storage}); }
    [[nodiscard]] Scene load(const LoadOptions& options) {
        std::ofstream(test::temporary("instances.bin"), std::ios::binary) << data_;
        document["buffers"] = {
            {{"byteLength", data_.size()},
             {"uri", std::filesystem::path(test::temporary("instances.bin")).filename()}}};
        json nodes;
        for (std::size_t i = 0; i < document["nodes"].size(); ++i) nodes.push_back(i);
        document["scenes"] = {{{"nodes", nodes}}};
        const std::string path = test::temporary("instances.gltf");
        std::ofstream(path) << document;
        Scene scene = load_scene(path, options);
        add_emitters(scene, 0);
        return scene;
    }

  private:
    template <class T>
    int add(const std::vector<T>& values, int component, const char* type, std::size_t count) {
        document["bufferViews"].push_back({{"buffer", 0},
                                           {"byteOffset", data_.size()},
                                           {"byteLength", values.size() * sizeof(T)}});
        data_.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
        document["accessors"].push_back({{"bufferView", document["bufferViews"].size() - 1},
                                         {"componentType", component},
                                         {"count", count},
                                         {"type", type}});
        return static_cast<int>(document["accessors"].size()) - 1;
    }

    json add_square(int material) {
        const int positions = add<float>(
            {-0.5f, 0, -0.5f, -0.5f, 0, 0.5f, 0.5f, 0, 0.5f, 0.5f, 0, -0.5f}, 5126, "VEC3", 4);
        const int indices = add<std::uint32_t>({0, 1, 2, 0, 2, 3}, 5125, "SCALAR", 6);
        return {{"primitives",
                 {{{"attributes", {{"POSITION", positions}}},
                   {"indices", indices},
                   {"material", material}}}}};
    }

    json add_shell() {
        std::vector<float> positions, normals, tangents, coordinates, colors;
        std::vector<std::uint32_t> indices;
        for (int i = 0; i <= side; ++i)
            for (int j = 0; j <= side; ++j) {
                const float u = static_cast<float>(i) / side;
                const float a = 3 * u - 1.5f;
                const float v = static_cast<float>(j) / side;
                for (const float x : {30 + 0.6f * std::sin(a), v - 0.5f, 0.6f * std::cos(a)})
                    positions.push_back(x);
                for (const float x : {std::sin(a), 0.f, std::cos(a)}) normals.push_back(x);
                for (const float x : {std::cos(a), 0.f, -std::sin(a), 1.f}) tangents.push_back(x);
                for (const float x : {2 * u, 3 * v}) coordinates.push_back(x);
                for (const float x : {1.f, 0.9f, 0.8f, (i + j) % 3 ? 1.f : 0.1f})
                    colors.push_back(x);
                if (i == side || j == side) continue;
                const auto at = static_cast<std::uint32_t>(i * (side + 1) + j);
                for (const std::uint32_t k :
                     {at, at + side + 1, at + side + 2, at, at + side + 2, at + 1})
                    indices.push_back(k);
            }
        const std::size_t count = positions.size() / 3;
        const std::size_t corners = indices.size();
        return {{"primitives",
                 {{{"attributes",
                    {{"POSITION", add(positions, 5126, "VEC3", count)},
                     {"NORMAL", add(normals, 5126, "VEC3", count)},
                     {"TANGENT", add(tangents, 5126, "VEC4", count)},
                     {"TEXCOORD_0", add(coordinates, 5126, "VEC2", count)},
                     {"COLOR_0", add(colors, 5126, "VEC4", count)}}},
                   {"indices", add(indices, 5125, "SCALAR", corners)},
                   {"material", 1}}}}};
    }

    std::string data_;
};

test::TestScene seen(Scene scene) {
    const Camera camera = make_camera(find_view(scene, ""), 60, 40);
    return {std::move(scene), camera, 60, 40};
}

}  // namespace

// Triangles of copies come in the order of their places, as those of instances do.
TEST(instances, are_where_copies_would_be) {
    InstancedFile file;
    const Scene shared = file.load(MeshStorage::shared);
    const Scene copied = file.load(MeshStorage::copied);
    constexpr std::size_t shell = 2 * side * side;
    ASSERT_EQ(shared.shared_meshes.size(), 1u);
    ASSERT_EQ(shared.instances.size(), 5u);
    EXPECT_EQ(shared.triangle_count(), 6 + shell);
    EXPECT_EQ(copied.triangle_count(), 6 + 5 * shell);
    EXPECT_EQ(shared.seen_triangle_count(), copied.triangle_count());
    EXPECT_EQ(shared.lights.size(), copied.lights.size());
    int mirrored = 0;
    for (std::size_t i = 0; i < 5; ++i) {
        mirrored += static_cast<int>(shared.instances[i].mirrored);
        EXPECT_EQ(shared.instances[i].mirrored,
                  glm::determinant(InstancedFile::place(static_cast<int>(i))) < 0);
        for (std::size_t t = 0; t < shell; ++t) {
            const reference::Triangle a(shared, static_cast<uint>(shared.instances[i].first + t));
            const reference::Triangle b(copied, static_cast<uint>(6 + i * shell + t));
            EXPECT_EQ(a.material(), b.material());
            EXPECT_LT(glm::length(glm::normalize(a.face()) - glm::normalize(b.face())), 1e-3);
            for (int k = 0; k < 3; ++k) {  // a mirrored copy's corners 1 and 2 are exchanged
                const int other = shared.instances[i].mirrored ? (3 - k) % 3 : k;
                EXPECT_LT(glm::length(a.corner(k) - b.corner(other)), 1e-5);
                EXPECT_LT(glm::length(a.normal(k) - b.normal(other)), 1e-5);
                EXPECT_LT(glm::length(a.tangent(k) - b.tangent(other)), 1e-5);
            }
        }
    }
    EXPECT_EQ(mirrored, 1);  // the other one is so twice
}

TEST(instances, look_as_copies_do) {
    for (const bool cull : {false, true}) {
        InstancedFile file;
        const test::TestScene shared =
            seen(file.load({.cull_back_faces = cull, .storage = MeshStorage::shared}));
        const test::TestScene copied =
            seen(file.load({.cull_back_faces = cull, .storage = MeshStorage::copied}));
        EXPECT_EQ(shared.scene.instances.size(), cull ? 4u : 5u);  // but for the mirrored one
        FOR_EACH_DEVICE(device) {
            RenderOptions options;
            options.sampler = "exhaustive";
            options.spp = 1;
            const Image a = test::render(device, shared, options).image;
            const Image b = test::render(device, copied, options).image;
            double lit = 0;
            std::size_t differ = 0;  // where rounding takes a ray past an edge
            for (unsigned y = 0; y < 40; ++y)
                for (unsigned x = 0; x < 60; ++x) {
                    lit += b.at(x, y)[1];
                    if (std::abs(a.at(x, y)[1] - b.at(x, y)[1]) > 1e-4f * (b.at(x, y)[1] + 1e-3f))
                        ++differ;
                }
            EXPECT_GT(lit, 100);
            EXPECT_LE(differ, 5u);
        }
    }
}

// Every kernel on a scene with holes and a normal map, by the reference; an orthographic camera's
// primary rays are traced one by one.
TEST(instances, every_stage) {
    for (const bool orthographic : {false, true}) {
        InstancedFile file;
        if (orthographic)
            file.document["cameras"][0] = {
                {"type", "orthographic"},
                {"orthographic", {{"xmag", 2.4}, {"ymag", 1.6}, {"znear", 0}, {"zfar", 9}}}};
        const test::TestScene scene = seen(file.load(MeshStorage::shared));
        FOR_EACH_DEVICE(device) {
            VerifyOptions options;
            options.width = scene.width;
            options.height = scene.height;
            options.most_entries = 8'000;
            Verifier verifier(device, scene.scene, scene.camera, options);
            for (const Check& check : verifier.all())
                if (check.tested()) test::expect_pass(check);
        }
    }
}

// Packets and single rays from everywhere, by the reference.
TEST(instances, rays) {
    InstancedFile file;
    const Scene scene = file.load(MeshStorage::shared);
    const Camera camera = make_camera(find_view(scene, ""), 60, 40);
    const reference::Tracer tracer(scene);
    std::mt19937 random(5);
    const auto in = [&](float lower, float upper) {
        return std::uniform_real_distribution(lower, upper)(random);
    };
    RaySet set{"random", false, false, std::vector<RayPacket>(300)};
    for (RayPacket& packet : set.packets) {
        packet.origin = {in(-3, 3), in(0.1f, 2.5f), in(-1, 3)};
        for (std::size_t lane = 0; lane < 16; ++lane) {
            const int i = static_cast<int>(lane) % 5;
            const glm::vec3 near(0.9f * static_cast<float>(i) - 1.8f, 0.7f,
                                 0.3f * static_cast<float>(i));
            const glm::vec3 to = near + 0.6f * glm::vec3(in(-1, 1), in(-1, 1), in(-1, 1));
            packet.x[lane] = to.x - packet.origin.x;
            packet.y[lane] = to.y - packet.origin.y;
            packet.z[lane] = to.z - packet.origin.z;
            packet.end[lane] = lane == 7 ? 0 : in(0.9f, 3);
        }
    }
    FOR_EACH_DEVICE(device) {
        Device d = device;
        const unsigned lanes = d.form().bvh_width;
        const WideBvh bvh = build_wide_bvh(scene, lanes, lanes, reach_of(scene, camera));
        for (const bool any_hit : {true, false}) {
            set.any_hit = any_hit;
            for (const Tracing& tracing :
                 DeviceTracer(d, upload_scene(d, scene, bvh, camera)).tracings(any_hit)) {
                tracing.prepare(set);
                tracing.run();
                const std::vector<float> found = tracing.collect();
                int hits = 0;
                int differ = 0;  // where rounding takes a ray past an edge or a hole's rim
                for (std::size_t i = 0; i < found.size(); ++i) {
                    const RayPacket& p = set.packets[i / 16];
                    if (!(p.end[i % 16] > 0)) continue;
                    const auto hit = tracer.closest_hit(
                        {p.origin, glm::dvec3(p.x[i % 16], p.y[i % 16], p.z[i % 16]),
                         p.end[i % 16]});
                    hits += hit.has_value();
                    differ += hit.has_value() != (found[i] < 1e30f) ||
                              (hit && !any_hit && std::abs(hit->t - found[i]) > 1e-4 * hit->t);
                }
                EXPECT_GT(hits, 1500) << tracing.name;
                EXPECT_LE(differ, 4) << tracing.name;
            }
        }
    }
}

// A mesh far from its own frame's origin is as exact as elsewhere, a tiny one has boxes of its own,
// and coincident surfaces that are partly there stop rays independently.
TEST(instances, hard_places) {
    InstancedFile file;
    file.add_place(glm::scale(glm::dmat4(1), glm::dvec3(1e-5)));
    const Scene scene = file.load(MeshStorage::shared);
    ASSERT_EQ(scene.instances.size(), 6u);
    for (const SharedMesh& mesh : scene.shared_meshes)
        EXPECT_LT(glm::length(mesh.bounds.centre()), 1e-3f);
    const WideBvh bvh = build_wide_bvh(scene, 8, 8, 100);
    for (int i = 0; i < 5; ++i) EXPECT_EQ(bvh.instances[i].root, bvh.instances[0].root);
    EXPECT_NE(bvh.instances[5].root, bvh.instances[0].root);
    const auto widest = [&](int node) {
        float upper = 0;
        for (unsigned lane = 0; lane < 8; ++lane)
            upper = std::max(upper, bvh.nodes[(7 * static_cast<std::size_t>(node) + 3) * 8 + lane]);
        return upper;
    };
    EXPECT_LT(widest(bvh.instances[0].root), 1.f);
    EXPECT_GT(widest(bvh.instances[5].root), 1.f);
}

// Two surfaces at one place, each there for half of the rays, let a quarter of them through.
TEST(instances, coincident_blends) {
    InstancedFile file;
    json& material = file.document["materials"][1];
    material = {
        {"pbrMetallicRoughness", {{"baseColorFactor", {0, 0, 0, 0.5}}, {"metallicFactor", 0}}},
        {"alphaMode", "BLEND"}};
    json& nodes = file.document["nodes"];
    for (int i = 0; i < 5; ++i) nodes.erase(nodes.size() - 1);
    const glm::dmat4 before =
        glm::scale(glm::translate(glm::dmat4(1), {0, 1.2, 3}), glm::dvec3(4)) *
        glm::translate(glm::dmat4(1), {-30, 0, 0});
    for (int i = 0; i < 2; ++i) file.add_place(before);
    for (const MeshStorage storage : {MeshStorage::shared, MeshStorage::copied}) {
        Scene scene = file.load(storage);
        for (float4& color : scene.colors) color.a = 1;
        find_alpha(scene);
        const test::TestScene test = seen(std::move(scene));
        FOR_EACH_DEVICE(device) {
            Device d = device;
            const WideBvh bvh = build_wide_bvh(test.scene, 8, 8, reach_of(test.scene, test.camera));
            const DeviceScene uploaded = upload_scene(d, test.scene, bvh, test.camera);
            RaySet set{"blend", true, false, std::vector<RayPacket>(500)};
            std::mt19937 random(3);
            for (RayPacket& packet : set.packets) {
                packet.origin = {0, 1.2f, 12};
                for (std::size_t lane = 0; lane < 16; ++lane) {
                    packet.x[lane] = std::uniform_real_distribution(-0.4f, 0.4f)(random);
                    packet.y[lane] = std::uniform_real_distribution(-0.4f, 0.4f)(random);
                    packet.z[lane] = -8.5f;
                    packet.end[lane] = 1;
                }
            }
            for (const Tracing& tracing : DeviceTracer(d, uploaded).tracings(true)) {
                tracing.prepare(set);
                tracing.run();
                int through = 0;
                for (const float t : tracing.collect()) through += t > 1e30f;
                EXPECT_NEAR(through / 8000.0, 0.25, 0.03) << tracing.name;
            }
        }
    }
}

// Without a camera, the view is the same.
TEST(instances, are_framed_as_copies_are) {
    InstancedFile file;
    const Bounds a = file.load(MeshStorage::shared).bounds();
    const Bounds b = file.load(MeshStorage::copied).bounds();
    EXPECT_LT(glm::length(a.lower - b.lower) + glm::length(a.upper - b.upper), 1e-5f);
}

// What gives light, changes its shape, stands alone or is too distorted.
TEST(instances, what_is_stored_as_copies) {
    const auto shared_meshes = [](const std::function<void(json&)>& change, MeshStorage storage) {
        InstancedFile file;
        change(file.document);
        return file.load(storage).shared_meshes.size();
    };
    const auto shell = [](json& d) -> json& { return d["meshes"][1]["primitives"][0]; };
    EXPECT_EQ(shared_meshes([](json&) {}, MeshStorage::shared), 1u);
    EXPECT_EQ(shared_meshes([](json&) {}, MeshStorage::copied), 0u);
    EXPECT_EQ(shared_meshes([](json&) {}, MeshStorage::automatic), 0u);  // it would save little
    EXPECT_EQ(shared_meshes([&](json& d) { shell(d)["material"] = 2; }, MeshStorage::shared), 0u);
    EXPECT_EQ(shared_meshes(
                  [&](json& d) {
                      shell(d)["targets"] = {{{"POSITION", shell(d)["attributes"]["POSITION"]}}};
                  },
                  MeshStorage::shared),
              0u);
    EXPECT_EQ(shared_meshes(
                  [](json& d) {
                      for (int i = 0; i < 4; ++i) d["nodes"].erase(d["nodes"].size() - 1);
                  },
                  MeshStorage::shared),
              0u);  // which stands in one place
    // What has no instance in the end is not stored for one.
    EXPECT_EQ(shared_meshes(
                  [](json& d) {
                      for (json& node : d["nodes"])
                          if (node.value("mesh", 0) == 1)
                              node = {{"mesh", 1}, {"scale", {1, 0, 1}}};
                  },
                  MeshStorage::shared),
              0u);
    // Of a place that single precision cannot take rays to, there is a copy.
    InstancedFile file;
    file.add_place(glm::scale(glm::dmat4(1), {1, 1, 0}));
    file.add_place(glm::scale(glm::dmat4(1), {1, 1, 1e-3}));
    const Scene scene = file.load(MeshStorage::shared);
    EXPECT_EQ(scene.instances.size(), 5u);
    EXPECT_EQ(scene.triangle_count(), 6 + 3 * 2u * side * side);
    EXPECT_EQ(scene.own_triangle_count(), 6 + 2 * 2u * side * side);
}

// Where copies would take more than 256 MiB, there are none, and the file fits in little memory.
TEST(instances, save_memory) {
    InstancedFile file;
    for (int i = 0; i < 40'000; ++i)
        file.add_place(glm::translate(glm::dmat4(1), {i % 100, i / 100, -5}));
    const Scene scene = file.load({.most_bytes = 64 << 20});
    EXPECT_EQ(scene.instances.size(), 40'005u);
    try {
        (void)file.load({.storage = MeshStorage::copied, .most_bytes = 64 << 20});
        ADD_FAILURE() << "copies fit";
    } catch (const InputError& error) {
        EXPECT_NE(std::string(error.what()).find("GiB of memory"), std::string::npos);
    }
}

}  // namespace manylight

// SPDX-License-Identifier: MIT
// A small glTF file that tests change and load.
#pragma once

#include <filesystem>
#include <fstream>
#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "scene/gltf/load.hpp"
#include "support.hpp"

namespace manylight::test {

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
        std::ofstream(temporary("data.bin"), std::ios::binary) << data;
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

    // Appends an accessor with a buffer of its own; returns its index.
    template <class T>
    int add(const std::vector<T>& values, int component, const char* type, std::size_t count) {
        const std::string name = fmt::format("more{}.bin", document["buffers"].size());
        const std::size_t bytes = values.size() * sizeof(T);
        std::ofstream(temporary(name), std::ios::binary)
            .write(reinterpret_cast<const char*>(values.data()), static_cast<long>(bytes));
        document["bufferViews"].push_back(
            {{"buffer", document["buffers"].size()}, {"byteLength", bytes}});
        document["buffers"].push_back(
            {{"byteLength", bytes},
             {"uri", std::filesystem::path(temporary(name)).filename().string()}});
        document["accessors"].push_back({{"bufferView", document["bufferViews"].size() - 1},
                                         {"componentType", component},
                                         {"count", count},
                                         {"type", type}});
        return static_cast<int>(document["accessors"].size()) - 1;
    }
    int add_floats(const std::vector<float>& values, const char* type, std::size_t count) {
        return add(values, 5126, type, count);
    }

    json& primitive() { return document["meshes"][0]["primitives"][0]; }

    [[nodiscard]] Scene load(std::optional<double> seconds = {}) const {
        return load(LoadOptions{.seconds = seconds});
    }
    [[nodiscard]] Scene load(const LoadOptions& options) const {
        const std::string path = temporary("test.gltf");
        std::ofstream(path) << document;
        return load_scene(path, options);
    }
};

// In the file's frame.
[[nodiscard]] inline std::vector<glm::vec3> triangle(const Scene& scene, std::size_t t) {
    const auto corner = [&](std::size_t k) {
        return glm::vec3(scene.in_file(scene.vertices[scene.indices[3 * t + k]]));
    };
    return {corner(0), corner(1), corner(2)};
}

inline void expect_near(glm::vec3 found, glm::vec3 expected) {
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(found[i], expected[i], 1e-5);
}

}  // namespace manylight::test

// SPDX-License-Identifier: MIT
// libFuzzer's target for scene files: whatever a file holds, load_scene() returns or throws
// InputError. An input is a .glb; mutations change its JSON as a tree, or its binary chunk.
#include <unistd.h>

#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numeric>
#include <random>

#include "error.hpp"
#include "scene/gltf/load.hpp"

using nlohmann::json;

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t most);

namespace {

constexpr std::uint32_t json_type = 0x4e4f534a;
constexpr std::uint32_t binary_type = 0x004e4942;

// A folder of this process with the images and the buffer that inputs may name.
const std::filesystem::path& folder() {
    static const std::filesystem::path path = [] {
        const std::filesystem::path out =
            std::filesystem::temp_directory_path() / ("manylight-fuzz-" + std::to_string(getpid()));
        std::filesystem::create_directory(out);
        for (const char* name : {"data.bin", "more.bin"})
            std::ofstream(out / name, std::ios::binary) << std::string(200, '\1');
        std::atexit([] { std::filesystem::remove_all(folder()); });
        return out;
    }();
    return path;
}

struct Parts {
    json document;
    std::string binary;
};

std::uint32_t word(const std::uint8_t* data) {
    std::uint32_t value = 0;
    std::memcpy(&value, data, 4);
    return value;
}

bool split(const std::uint8_t* data, std::size_t size, Parts& out) {
    if (size < 20 || std::memcmp(data, "glTF", 4) != 0) return false;
    const std::size_t length = word(data + 12);
    if (word(data + 16) != json_type || length > size - 20) return false;
    out.document = json::parse(data + 20, data + 20 + length, nullptr, false);
    if (out.document.is_discarded()) return false;
    if (size - 20 - length > 8)
        out.binary.assign(reinterpret_cast<const char*>(data) + 28 + length, size - 28 - length);
    return true;
}

// 0 where it is too large.
std::size_t join(const Parts& parts, std::uint8_t* data, std::size_t most) {
    std::string text = parts.document.dump(-1, ' ', false, json::error_handler_t::replace);
    text.resize((text.size() + 3) / 4 * 4, ' ');
    std::string binary = parts.binary;
    binary.resize((binary.size() + 3) / 4 * 4);
    std::string out = "glTF";
    const auto add = [&out](std::size_t value) {
        const auto v = static_cast<std::uint32_t>(value);
        out.append(reinterpret_cast<const char*>(&v), 4);
    };
    add(2);
    add(28 + text.size() + binary.size());
    add(text.size());
    add(json_type);
    out += text;
    add(binary.size());
    add(binary_type);
    out += binary;
    if (out.size() > most) return 0;
    std::memcpy(data, out.data(), out.size());
    return out.size();
}

void list(json& value, std::vector<json*>& out) {
    out.push_back(&value);
    if (value.is_structured())
        for (json& child : value) list(child, out);
}

json new_value(std::mt19937& random) {
    static const json values[] = {0,
                                  1,
                                  2,
                                  3,
                                  4,
                                  5,
                                  7,
                                  12,
                                  16,
                                  64,
                                  255,
                                  256,
                                  65535,
                                  65536,
                                  1 << 24,
                                  0x7fffffff,
                                  0xffffffffu,
                                  -1,
                                  4294967296,
                                  0x7fffffffffffffff,
                                  0.5,
                                  -0.5,
                                  1e-30,
                                  1e30,
                                  1e308,
                                  5120,
                                  5121,
                                  5122,
                                  5123,
                                  5125,
                                  5126,
                                  34962,
                                  10497,
                                  true,
                                  false,
                                  nullptr,
                                  "",
                                  "SCALAR",
                                  "VEC2",
                                  "VEC3",
                                  "VEC4",
                                  "MAT4",
                                  "POSITION",
                                  "NORMAL",
                                  "TANGENT",
                                  "TEXCOORD_0",
                                  "COLOR_0",
                                  "JOINTS_0",
                                  "WEIGHTS_0",
                                  "MASK",
                                  "BLEND",
                                  "data.bin",
                                  "..",
                                  "%2e%2e/data.bin",
                                  "data%zz.bin",
                                  "./data.bin",
                                  "data:application/octet-stream;base64,AAAA",
                                  "ATTRIBUTES",
                                  "TRIANGLES",
                                  "INDICES",
                                  "OCTAHEDRAL",
                                  "QUATERNION",
                                  "EXPONENTIAL",
                                  "LINEAR",
                                  "STEP",
                                  "CUBICSPLINE",
                                  "translation",
                                  "rotation",
                                  "weights",
                                  "image/png",
                                  json::array(),
                                  json::object()};
    return values[random() % std::size(values)];
}

void mutate(json& document, std::mt19937& random) {
    std::vector<json*> all;
    list(document, all);
    json& value = *all[random() % all.size()];
    const json other = *all[random() % all.size()];
    switch (random() % 6) {
        case 0:
            value = other;
            return;
        case 1:
            if (value.is_array() && !value.empty()) value.erase(random() % value.size());
            if (value.is_object() && !value.empty())
                value.erase(std::next(value.begin(), random() % value.size()));
            return;
        case 2:
            if (value.is_array()) value.push_back(value.empty() ? other : value[0]);
            if (value.is_object() && other.is_object()) value.update(other);
            return;
        case 3:
            if (value.is_number_integer())
                value = static_cast<std::int64_t>(value.get<std::uint64_t>() + random() % 9 - 4);
            return;
        default:
            value = new_value(random);
    }
}

}  // namespace

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size,
                                               std::size_t most, unsigned seed) {
    std::mt19937 random(seed);
    Parts parts;
    if (random() % 16 == 0 || !split(data, size, parts)) return LLVMFuzzerMutate(data, size, most);
    if (random() % 4 == 0 && !parts.binary.empty()) {
        std::string& binary = parts.binary;
        const std::size_t old = binary.size();
        binary.resize(old + 64);
        binary.resize(
            LLVMFuzzerMutate(reinterpret_cast<std::uint8_t*>(binary.data()), old, binary.size()));
    } else {
        for (unsigned i = 0; i <= random() % 4; ++i) mutate(parts.document, random);
    }
    const std::size_t changed = join(parts, data, most);
    return changed > 0 ? changed : LLVMFuzzerMutate(data, size, most);
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::filesystem::path file = folder() / "scene.glb";
    std::ofstream(file, std::ios::binary)
        .write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
    const unsigned chance = std::accumulate(data, data + size, 0u);  // the input's own
    try {
        manylight::Scene scene = manylight::load_scene(
            file.string(), {.seconds = chance % 2 ? std::optional(0.5) : std::nullopt,
                            .variant = chance % 8 < 2 ? "red" : "",
                            .storage = chance % 4 < 2 ? manylight::MeshStorage::shared
                                                      : manylight::MeshStorage::copied,
                            .most_bytes = std::size_t{1} << 28});
        manylight::add_emitters(scene, 0);
        (void)scene.bounds();
    } catch (const manylight::InputError&) {
    }
    return 0;
}

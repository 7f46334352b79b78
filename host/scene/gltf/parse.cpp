// SPDX-License-Identifier: MIT
// tinygltf's implementation, alone in its file: it takes long to compile.
#define TINYGLTF_IMPLEMENTATION
#define TINYGLTF_NO_STB_IMAGE
#define TINYGLTF_NO_STB_IMAGE_WRITE
#define TINYGLTF_NO_EXTERNAL_IMAGE
#include "scene/gltf/parse.hpp"

#include <algorithm>
#include <filesystem>

#include "error.hpp"
#include "scene/gltf/uri.hpp"

namespace manylight {
namespace {

using nlohmann::json;

// Accessors whose elements are compressed with their primitive (KHR_draco_mesh_compression), or 0.
bool lacks_view(const json& accessor) { return !accessor.contains("bufferView"); }

// The file without its data, which are not the library's business, and without what it refuses:
// indices, for one, need a view.
std::string without_data(const GltfFile& file) {
    json out = json::object();
    for (const auto& [key, value] : file.json.items())
        if (key != "images" && key != "buffers") out[key] = value;
    if (file.json.contains("buffers"))
        for (std::size_t i = 0; i < file.json["buffers"].size(); ++i)
            out["buffers"].push_back(
                {{"byteLength", 1}, {"uri", "data:application/octet-stream;base64,AA=="}});
    if (out.contains("accessors") && out.contains("bufferViews"))
        for (json& accessor : out["accessors"])
            if (lacks_view(accessor)) accessor["bufferView"] = 0;
    return out.dump();
}

std::vector<unsigned char> bytes_of_buffer(const GltfFile& file, std::size_t index) {
    if (!has_data(file, index)) return {};
    const json& buffer = file.json["buffers"][index];
    const std::string where = fmt::format("{}: buffers[{}]", file.path, index);
    const auto length = buffer["byteLength"].get<std::size_t>();
    std::vector<unsigned char> bytes =
        buffer.contains("uri")
            ? bytes_of_uri(file, buffer["uri"].get_ref<const std::string&>(), where + ".uri")
            : *file.binary;
    if (bytes.size() < length)
        throw InputError("{}.byteLength: {} bytes, but there are {}", where, length, bytes.size());
    bytes.resize(length);
    return bytes;
}

bool skip_image(tinygltf::Image*, const int, std::string*, std::string*, int, int,
                const unsigned char*, int, void*) {
    return true;
}

// The library decodes URIs otherwise than we do: these keep it within the scene's folder.
bool is_within(const std::string& file, void* data) {
    namespace fs = std::filesystem;
    const auto& folder = *static_cast<const fs::path*>(data);
    std::error_code error;
    const fs::path target = fs::canonical(file.c_str(), error);
    return !error && std::ranges::mismatch(folder, target).in1 == folder.end();
}

bool read_within(std::vector<unsigned char>* out, std::string* why, const std::string& file,
                 void* folder) {
    return is_within(file, folder) && tinygltf::ReadWholeFile(out, why, file, nullptr);
}

}  // namespace

tinygltf::Model parse_gltf(const GltfFile& file) {
    tinygltf::TinyGLTF parser;
    parser.SetImageLoader(skip_image, nullptr);
    tinygltf::Model model;
    std::string error;
    std::string warning;
    const std::string text = without_data(file);
    const bool parsed = parser.LoadASCIIFromString(&model, &error, &warning, text.data(),
                                                   static_cast<unsigned>(text.size()), "");
    if (!parsed) {
        while (!error.empty() && error.back() == '\n') error.pop_back();
        std::ranges::replace(error, '\n', ' ');
        throw InputError("{}: {}", file.path, error.substr(0, 300));
    }
    for (std::size_t i = 0; i < model.accessors.size(); ++i)
        if (lacks_view(file.json["accessors"][i])) model.accessors[i].bufferView = -1;
    for (std::size_t i = 0; i < model.buffers.size(); ++i)
        model.buffers[i].data = bytes_of_buffer(file, i);
    return model;
}

void parse_alone(const std::string& path) {
    tinygltf::TinyGLTF parser;
    parser.SetImageLoader(skip_image, nullptr);
    std::filesystem::path folder =
        std::filesystem::canonical(std::filesystem::absolute(path).parent_path());
    parser.SetFsCallbacks({is_within, tinygltf::ExpandFilePath, read_within, nullptr, &folder});
    tinygltf::Model model;
    std::string error;
    std::string warning;
    const bool parsed = path.ends_with(".glb")
                            ? parser.LoadBinaryFromFile(&model, &error, &warning, path)
                            : parser.LoadASCIIFromFile(&model, &error, &warning, path);
    if (!parsed) throw InputError("{}: {}", path, error);
}

}  // namespace manylight

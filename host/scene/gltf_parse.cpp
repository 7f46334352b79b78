// SPDX-License-Identifier: MIT
// tinygltf's implementation, alone in its file: it takes long to compile.
#define TINYGLTF_IMPLEMENTATION
#define TINYGLTF_NO_STB_IMAGE
#define TINYGLTF_NO_STB_IMAGE_WRITE
#define TINYGLTF_NO_EXTERNAL_IMAGE
#include "scene/gltf_parse.hpp"

#include <algorithm>
#include <cstring>
#include <filesystem>

#include "error.hpp"

namespace manylight {
namespace {

// The library refuses images in data URIs of types that it does not know, such as WebP, and reads
// whole those beside the file; they are not its business.
bool has_images_by_name(const nlohmann::json& json) {
    return json.contains("images") &&
           std::ranges::any_of(json["images"],
                               [](const nlohmann::json& image) { return image.contains("uri"); });
}

bool uri_has_plus(const nlohmann::json& buffer) {
    return buffer.contains("uri") &&
           !buffer["uri"].get_ref<const std::string&>().starts_with("data:") &&
           buffer["uri"].get_ref<const std::string&>().find('+') != std::string::npos;
}

// The library takes a plus for a blank.
bool any_uri_has_plus(const GltfFile& file) {
    return file.json.contains("buffers") &&
           std::ranges::any_of(file.json["buffers"],
                               [](const nlohmann::json& buffer) { return uri_has_plus(buffer); });
}

void escape_plus(std::string& uri) {
    for (std::size_t at = 0; (at = uri.find('+', at)) != std::string::npos;)
        uri.replace(at, 1, "%2B");
}

// Buffers that only say how large others are when decompressed (EXT_meshopt_compression).
bool has_fallback_buffers(const GltfFile& file) {
    return file.json.contains("buffers") &&
           std::ranges::any_of(file.json["buffers"], is_fallback_buffer);
}

// Accessors whose elements are compressed with their primitive (KHR_draco_mesh_compression).
bool lacks_view(const nlohmann::json& accessor) { return !accessor.contains("bufferView"); }

bool has_accessors_without_view(const GltfFile& file) {
    return file.json.contains("accessors") && file.json.contains("bufferViews") &&
           std::ranges::any_of(file.json["accessors"], lacks_view);
}

// The file without what the library refuses: indices, for one, need a view.
std::vector<unsigned char> without_refused(const GltfFile& file) {
    nlohmann::json json = file.json;
    json.erase("images");
    if (json.contains("buffers")) {
        for (nlohmann::json& buffer : json["buffers"])
            if (is_fallback_buffer(buffer))
                buffer = {{"byteLength", 1}, {"uri", "data:application/octet-stream;base64,AA=="}};
            else if (uri_has_plus(buffer))
                escape_plus(buffer["uri"].get_ref<std::string&>());
    }
    if (has_accessors_without_view(file))
        for (nlohmann::json& accessor : json["accessors"])
            if (lacks_view(accessor)) accessor["bufferView"] = 0;
    std::string text = json.dump();
    if (!file.is_binary) return {text.begin(), text.end()};
    text.resize((text.size() + 3) / 4 * 4, ' ');
    std::uint32_t old_length = 0;
    std::memcpy(&old_length, file.bytes.data() + 12, 4);
    std::vector<unsigned char> out(file.bytes.begin(), file.bytes.begin() + 20);
    out.insert(out.end(), text.begin(), text.end());
    out.insert(out.end(), file.bytes.begin() + 20 + old_length, file.bytes.end());
    const auto length = static_cast<std::uint32_t>(text.size());
    const auto total = static_cast<std::uint32_t>(out.size());
    std::memcpy(out.data() + 8, &total, 4);
    std::memcpy(out.data() + 12, &length, 4);
    return out;
}

bool skip_image(tinygltf::Image*, const int, std::string*, std::string*, int, int,
                const unsigned char*, int, void*) {
    return true;
}

}  // namespace

tinygltf::Model parse_gltf(const GltfFile& file) {
    tinygltf::TinyGLTF parser;
    parser.SetImageLoader(skip_image, nullptr);
    tinygltf::Model model;
    std::string error;
    std::string warning;
    std::vector<unsigned char> changed;
    if (has_images_by_name(file.json) || has_fallback_buffers(file) || any_uri_has_plus(file) ||
        has_accessors_without_view(file))
        changed = without_refused(file);
    const std::vector<unsigned char>& bytes = changed.empty() ? file.bytes : changed;
    const auto length = static_cast<unsigned>(bytes.size());
    const std::string folder = std::filesystem::absolute(file.path).parent_path().string();
    const bool parsed =
        file.is_binary
            ? parser.LoadBinaryFromMemory(&model, &error, &warning, bytes.data(), length, folder)
            : parser.LoadASCIIFromString(&model, &error, &warning,
                                         reinterpret_cast<const char*>(bytes.data()), length,
                                         folder);
    if (!parsed) {
        while (!error.empty() && error.back() == '\n') error.pop_back();
        std::ranges::replace(error, '\n', ' ');
        throw InputError("{}: {}", file.path, error.substr(0, 300));
    }
    for (std::size_t i = 0; i < model.accessors.size(); ++i)
        if (lacks_view(file.json["accessors"][i])) model.accessors[i].bufferView = -1;
    return model;
}

void parse_alone(const std::string& path) {
    tinygltf::TinyGLTF parser;
    parser.SetImageLoader(skip_image, nullptr);
    tinygltf::Model model;
    std::string error;
    std::string warning;
    const bool parsed = path.ends_with(".glb")
                            ? parser.LoadBinaryFromFile(&model, &error, &warning, path)
                            : parser.LoadASCIIFromFile(&model, &error, &warning, path);
    if (!parsed) throw InputError("{}: {}", path, error);
}

}  // namespace manylight

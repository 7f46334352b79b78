// SPDX-License-Identifier: MIT
#include "scene/gltf/check.hpp"

#include <algorithm>

#include "scene/gltf/checking.hpp"
#include "scene/gltf/extensions.hpp"
#include "scene/gltf/uri.hpp"

namespace manylight {
namespace {

void check_asset(const JsonValue& root) {
    const JsonValue asset = root["asset"].object();
    const JsonValue version = asset["version"];
    std::string digits = version.shown();  // some files of glTF 1.0 have a number there
    std::erase(digits, '"');
    if (digits == "1" || digits.starts_with("1.") || digits.starts_with("0."))
        version.refuse("{} is not 2.x; gltf-pipeline -i OLD -o NEW.glb converts it",
                       version.shown());
    if (!version.string().starts_with("2.")) version.refuse("{} is not 2.x", version.shown());
    if (asset.has("minVersion") && asset["minVersion"].string() != "2.0")
        asset["minVersion"].refuse("{} is newer than 2.0", asset["minVersion"].shown());
}

void check_extensions(const JsonValue& root) {
    for (const char* key : {"extensionsUsed", "extensionsRequired"}) {
        if (!root.has(key)) continue;
        const JsonValue names = root[key].array();
        for (std::size_t i = 0; i < names.size(); ++i) {
            const std::string name = names.at(i).string();
            if (std::string_view(key) == "extensionsUsed") continue;
            if (name == "KHR_texture_basisu")
                names.at(i).refuse(
                    "KTX2 textures of {} are not read; gltf-transform ktxdecompress OLD "
                    "NEW.glb converts them",
                    name);
            if (extension_kind(name) == Extension::unknown)
                names.at(i).refuse("the file cannot be rendered without {}, which is not known",
                                   name);
        }
    }
}

}  // namespace

void Checking::uri(const JsonValue& value, bool of_buffer) {
    const std::string text = value.string();
    if (text.starts_with("data:")) {
        const std::string head = text.substr(0, std::min(text.find(','), std::size_t{60}));
        if (!head.ends_with(";base64")) value.refuse("'{}': the data is not base64", head);
        if (of_buffer && head != "data:application/octet-stream;base64" &&
            head != "data:application/gltf-buffer;base64")
            value.refuse("'{}' is no type of a buffer's data", head);
        return;
    }
    const std::filesystem::path path = file_of_uri(file, text, value.where());
    std::error_code error;
    if (!of_buffer) return;
    if (!std::filesystem::is_regular_file(path, error))
        value.refuse("{}: no such file beside the scene", value.shown());
    // Some thousands of buffers that name one file would be as many copies of it.
    if (!buffer_files.insert(path).second)
        value.refuse("{} is another buffer's file too", value.shown());
}

void Checking::decompress(std::uint64_t bytes, const JsonValue& what) {
    const std::uint64_t most = 16 * stored + (std::uint64_t{1} << 28);
    decompressed += bytes;
    if (decompressed > most) what.refuse("the file would decompress to more than {} bytes", most);
}

void check_gltf(const GltfFile& file) {
    Checking in(file);
    if (!file.json.is_object())
        throw InputError("{}: JSON: {} is not an object", file.path, in.root.shown());
    check_asset(in.root);
    check_extensions(in.root);
    check_data(in);
    check_materials(in);
    check_meshes(in);
    check_nodes(in);
}

}  // namespace manylight

// SPDX-License-Identifier: MIT
// A glTF file as JSON and bytes.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "scene/notes.hpp"

namespace manylight {

/// A glTF file before it has a meaning.
struct GltfFile {
    std::string path;
    nlohmann::json json;
    std::optional<std::vector<unsigned char>> binary;  // the BIN chunk of a .glb
    Notes notes;                                       // what was read otherwise than it says
};

/// Reads and parses; checks the container, the nesting depth and the JSON syntax.
[[nodiscard]] GltfFile read_gltf(const std::string& path);

/// The bytes of a regular file, at most 4 GiB. Throws InputError.
[[nodiscard]] std::vector<unsigned char> read_file(const std::string& path);

constexpr const char* draco_extension = "KHR_draco_mesh_compression";

/// The extension by which a buffer view is compressed: EXT_meshopt_compression, or
/// KHR_meshopt_compression, which says the same. Null: it is not.
[[nodiscard]] const char* compression_of(const nlohmann::json& buffer_view);

/// Whether a buffer has data; others only say how large compressed buffer views are when
/// decompressed.
[[nodiscard]] bool has_data(const GltfFile& file, std::size_t buffer);

}  // namespace manylight

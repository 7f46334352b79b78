// SPDX-License-Identifier: MIT
// What the URIs of a glTF file name. All that is read beside a scene is read here.
#pragma once

#include "scene/gltf/file.hpp"

namespace manylight {

/// The file that a URI names, links followed: a plain relative path from the scene's folder, once
/// its %XX are decoded, to what lies in that folder or one below it. Throws InputError that starts
/// with `where` for any other. The file need not exist.
[[nodiscard]] std::filesystem::path file_of_uri(const GltfFile& file, const std::string& uri,
                                                const std::string& where);

/// The bytes of a data URI in base64, or of the file that a URI names. Throws InputError that
/// starts with `where`.
[[nodiscard]] std::vector<unsigned char> bytes_of_uri(const GltfFile& file, const std::string& uri,
                                                      const std::string& where);

}  // namespace manylight

// SPDX-License-Identifier: MIT
// glTF 2.0 files to scenes. What is read and what is warned about: docs/scenes.md.
#pragma once

#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "scene/scene.hpp"

namespace manylight {

/// How meshes are stored that stand in several places: once with instances where that saves memory,
/// a copy for each place (faster to trace), or, `automatic`, once where copies would take much
/// more.
enum class MeshStorage { automatic, shared, copied };

struct LoadOptions {
    std::optional<double> seconds = {};  // the moment of the first animation; none: all at rest
    double lamp_scale = 1;               // of punctual lights' intensities
    bool cull_back_faces = false;        // of materials that are not doubleSided
    MeshStorage storage = MeshStorage::automatic;
    std::size_t most_bytes = 0;  // that triangles, or textures, may need; 0: what the machine has
    std::function<void(double)> report = {};  // gets the share done now and then
};

/// Loads a .gltf or .glb file. Throws InputError naming the file, the object and the value for
/// everything that the glTF 2.0 specification forbids and that loading depends on.
///
/// Emissive triangles are no lights yet (see add_emitters), and powers are not set. The first
/// scene's extras may hold "emitter_points", the number of oriented points that its emitters are
/// meant to be rendered with.
///
[[nodiscard]] Scene load_scene(const std::string& path, const LoadOptions& options = {});

/// A glTF file before it has a meaning.
struct GltfFile {
    std::string path;
    std::vector<unsigned char> bytes;  // the whole file
    bool is_binary = false;            // .glb
    nlohmann::json json;
};

/// Reads and parses; checks the container, the nesting depth and the JSON syntax.
[[nodiscard]] GltfFile read_gltf(const std::string& path);

/// The file that a relative URI names: percent-decoded, seen from the scene's folder, links
/// followed.
[[nodiscard]] std::filesystem::path path_of_uri(const GltfFile& file, const std::string& uri);

/// The bytes of the file that a URI names, which check_gltf() has found to lead nowhere else.
/// Throws InputError that starts with `where`.
[[nodiscard]] std::vector<unsigned char> read_beside(const GltfFile& file, const std::string& uri,
                                                     const std::string& where);

constexpr const char* draco_extension = "KHR_draco_mesh_compression";

/// The extensions that are rendered.
[[nodiscard]] const std::set<std::string>& known_extensions();

/// Whether a buffer has no data: it only says how large others are when decompressed
/// (EXT_meshopt_compression).
[[nodiscard]] bool is_fallback_buffer(const nlohmann::json& buffer);

/// Checks all values of the JSON: types, ranges, indices, node hierarchy, URIs, versions.
void check_gltf(const GltfFile& file);

}  // namespace manylight

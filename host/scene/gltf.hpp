// SPDX-License-Identifier: MIT
// glTF 2.0 files to scenes. What is read and what is warned about: docs/scenes.md.
#pragma once

#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "scene/notes.hpp"
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
    std::string variant = {};  // of KHR_materials_variants; empty: the file's own materials
    MeshStorage storage = MeshStorage::automatic;
    std::size_t most_bytes = 0;  // that triangles, or textures, may need; 0: what the machine has
    std::function<void(double)> report = {};  // gets the share done now and then
};

/// Loads a .gltf or .glb file. Throws InputError naming the file, the object and the value for
/// everything that the glTF 2.0 specification forbids and that loading depends on.
///
/// Emissive triangles are no lights yet (see add_emitters), and powers are not set. The first
/// scene's extras may hold "emitter_points", the number of oriented points that its emitters are
/// meant to be rendered with. A scene far from the file's origin is read again about its own (see
/// find_origin()).
[[nodiscard]] Scene load_scene(const std::string& path, const LoadOptions& options = {});

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

/// Checks all values of the JSON: types, ranges, indices, node hierarchy, URIs, versions. Throws
/// InputError for what has no sensible reading.
void check_gltf(const GltfFile& file);

/// Changes the JSON, which check_gltf() has passed, to glTF that says what the file means: where it
/// breaks the specification (and warns), by the extensions that hide nodes and choose materials,
/// and where its materials are of specular and glossiness. Throws InputError for a variant that
/// there is not; empty: none.
void mend_gltf(GltfFile& file, const std::string& variant);

}  // namespace manylight

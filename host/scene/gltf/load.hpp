// SPDX-License-Identifier: MIT
// glTF 2.0 files to scenes. What is read and what is warned about: docs/scenes.md.
#pragma once

#include <functional>
#include <optional>
#include <string>

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

}  // namespace manylight

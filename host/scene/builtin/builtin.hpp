// SPDX-License-Identifier: MIT
// Scenes that the program can make itself, as .glb files.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "scene/gltf_writer.hpp"

namespace manylight {

struct BuiltinOptions {
    unsigned lights = 0;  // 0: the scene's own number; only city takes another
    std::string mesh;     // only dragon takes one: a glTF file
};

struct Builtin {
    std::string_view name;
    std::string_view summary;
    void (*make)(GltfWriter& out, const BuiltinOptions& options);
    bool takes_lights = false;
    bool takes_mesh = false;
};

/// cornell, dragon, rooms, city, glossy, blinds, pinhole, plates.
[[nodiscard]] std::span<const Builtin> all_builtins();

/// Throws InputError for a name that is not in the list or options that the scene does not take.
[[nodiscard]] GltfWriter make_builtin(const std::string& name, const BuiltinOptions& options);

// One file each.
void make_cornell(GltfWriter& out, const BuiltinOptions& options);
void make_dragon(GltfWriter& out, const BuiltinOptions& options);
void make_rooms(GltfWriter& out, const BuiltinOptions& options);
void make_city(GltfWriter& out, const BuiltinOptions& options);
void make_glossy(GltfWriter& out, const BuiltinOptions& options);
void make_blinds(GltfWriter& out, const BuiltinOptions& options);
void make_pinhole(GltfWriter& out, const BuiltinOptions& options);
void make_plates(GltfWriter& out, const BuiltinOptions& options);

}  // namespace manylight

// SPDX-License-Identifier: MIT
// Scenes that the program can make itself, as .glb files.
#pragma once

#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "scene/gltf/writer.hpp"

namespace manylight {

/// A number that a built-in scene takes: --NAME of manylight scene.
struct SceneParameter {
    std::string_view name;
    std::string_view summary;  // with its unit
    bool whole = false;
    double usual = 0;
    std::vector<double> sweep;  // from harmless to hopeless; the ends are its limits

    [[nodiscard]] double least() const { return std::min(sweep.front(), sweep.back()); }
    [[nodiscard]] double most() const { return std::max(sweep.front(), sweep.back()); }
};

struct BuiltinOptions {
    std::map<std::string, double, std::less<>> values = {};  // of parameters; otherwise usual ones
    std::string mesh = {};                                   // only dragon takes one: a glTF file

    /// The value of a parameter.
    [[nodiscard]] float number(std::string_view name) const;
    [[nodiscard]] unsigned count(std::string_view name) const;
};

struct Builtin {
    std::string_view name;
    std::string_view summary;
    void (*make)(GltfWriter& out, const BuiltinOptions& options);
    std::vector<SceneParameter> parameters = {};
    bool takes_mesh = false;
};

[[nodiscard]] std::span<const Builtin> all_builtins();

/// Throws InputError for a name that is not in the list or options that the scene does not take.
[[nodiscard]] GltfWriter make_builtin(const std::string& name, const BuiltinOptions& options);

// One file each.
void make_blinds(GltfWriter& out, const BuiltinOptions& options);
void make_boards(GltfWriter& out, const BuiltinOptions& options);
void make_city(GltfWriter& out, const BuiltinOptions& options);
void make_cornell(GltfWriter& out, const BuiltinOptions& options);
void make_dragon(GltfWriter& out, const BuiltinOptions& options);
void make_forest(GltfWriter& out, const BuiltinOptions& options);
void make_glossy(GltfWriter& out, const BuiltinOptions& options);
void make_hidden(GltfWriter& out, const BuiltinOptions& options);
void make_near(GltfWriter& out, const BuiltinOptions& options);
void make_pinhole(GltfWriter& out, const BuiltinOptions& options);
void make_plates(GltfWriter& out, const BuiltinOptions& options);
void make_range(GltfWriter& out, const BuiltinOptions& options);
void make_rooms(GltfWriter& out, const BuiltinOptions& options);
void make_stacks(GltfWriter& out, const BuiltinOptions& options);
void make_street(GltfWriter& out, const BuiltinOptions& options);
void make_thicket(GltfWriter& out, const BuiltinOptions& options);
void make_tubes(GltfWriter& out, const BuiltinOptions& options);
void make_vault(GltfWriter& out, const BuiltinOptions& options);

}  // namespace manylight

// SPDX-License-Identifier: MIT
// What the parts of check_gltf() share. One function per kind of object; each line states a rule of
// the glTF 2.0 specification or of a KHR extension.
#pragma once

#include <filesystem>
#include <set>

#include "scene/gltf/file.hpp"
#include "scene/json_value.hpp"

namespace manylight {

/// A file that is being checked. Every function throws InputError naming the object.
struct Checking {
    explicit Checking(const GltfFile& file) : file(file), root(file.path, "", file.json) {}

    /// How many objects of a kind there are: "nodes", "meshes", ...
    [[nodiscard]] std::size_t count(const char* kind) const {
        return root.has(kind) ? root[kind].array().size() : 0;
    }
    /// Calls `check(object, index)` for each of them.
    template <class Check>
    void each(const char* kind, const Check& check) const {
        for (std::size_t i = 0; i < count(kind); ++i) check(root[kind].at(i).object(), i);
    }
    /// Checks an index of an object of a kind, called `what` in messages, where there is one.
    void optional_index(const JsonValue& object, const char* key, const char* kind,
                        const char* what) const {
        if (object.has(key)) (void)object[key].index(count(kind), what);
    }
    /// A data URI, or a relative path that stays in the scene's folder. What a buffer names has to
    /// be there, and no other buffer's.
    void uri(const JsonValue& value, bool of_buffer);

    /// Counts what data decompress to, and refuses more than a file of its size may.
    void decompress(std::uint64_t bytes, const JsonValue& what);

    const GltfFile& file;
    JsonValue root;
    std::uint64_t stored = 0;        // bytes of buffers
    std::uint64_t decompressed = 0;  // bytes, so far
    std::set<std::filesystem::path> buffer_files;
};

// In this order; later ones take for granted what earlier ones have checked.
void check_data(Checking& in);       // buffers, buffer views, accessors
void check_materials(Checking& in);  // images, samplers, textures, materials
void check_meshes(Checking& in);
void check_nodes(Checking& in);  // cameras, lights, skins, nodes, animations, scenes

}  // namespace manylight

// SPDX-License-Identifier: MIT
// The numbers of a glTF file: accessors, sparse or not, quantized (KHR_mesh_quantization) or not,
// in buffer views compressed (EXT_meshopt_compression) or not.
#pragma once

#include <glm/glm.hpp>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "scene/gltf/file.hpp"
#include "scene/gltf/parse.hpp"

namespace manylight {

/// What an accessor is read for, which says what types it may have.
enum class Attribute {
    position,
    normal,
    tangent,
    coordinates,
    color,
    joints,
    weights,
    rotation,
    scalar,
    value  // of an animation, numbers or vectors
};

/// Reads accessors of a file that check_gltf() has passed. Every function throws InputError naming
/// the file, `where` and the value.
class Accessors {
  public:
    /// Both live longer.
    Accessors(const GltfFile& file, const tinygltf::Model& model);

    /// The elements as floats: integers as they are, or as fractions where they are normalized.
    /// Missing components are 1. Normals and tangents that are not finite are 0.
    [[nodiscard]] std::vector<glm::vec4> vectors(int accessor, Attribute attribute,
                                                 const std::string& where);
    /// Vertex numbers.
    [[nodiscard]] std::vector<std::uint32_t> indices(int accessor, const std::string& where);
    /// 4 x 4 matrices of floats.
    [[nodiscard]] std::vector<glm::mat4> matrices(int accessor, const std::string& where);

    /// Has an accessor read `bytes`, packed, instead of its buffer view.
    void provide(int accessor, std::vector<unsigned char> bytes) {
        provided_[accessor] = std::move(bytes);
    }
    /// What was read otherwise than the file says.
    [[nodiscard]] const Notes& notes() const { return notes_; }
    /// The bytes of a buffer view, decompressed.
    [[nodiscard]] std::span<const unsigned char> view_bytes(int view);

  private:
    struct Elements {
        const unsigned char* data;
        std::size_t stride;
        std::size_t count;
        std::vector<unsigned char> own;  // of sparse ones: data points there
    };

    [[nodiscard]] Elements elements(int accessor, const std::string& where);
    void substitute(const tinygltf::Accessor& accessor, std::size_t bytes, const std::string& where,
                    std::vector<unsigned char>& out);
    [[nodiscard]] std::vector<unsigned char> decompress(int view, const nlohmann::json& compressed);

    const GltfFile& file_;
    const tinygltf::Model& model_;
    bool quantized_;
    Notes notes_;
    std::map<int, std::vector<unsigned char>> decompressed_;  // by buffer view
    std::map<int, std::vector<unsigned char>> provided_;      // by accessor
};

}  // namespace manylight

// SPDX-License-Identifier: MIT
#include "scene/gltf/accessors.hpp"

#include <meshoptimizer.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "error.hpp"

namespace manylight {
namespace {

enum class Allowed { never, quantized, always };  // quantized: with KHR_mesh_quantization

// What types an attribute may have.
struct Form {
    const char* name;
    int fewest, most;  // components
    bool floats;
    Allowed fractions, signed_fractions;  // 8 or 16 bits, normalized
    Allowed integers, signed_integers;    // 8 or 16 bits, not normalized
};

const Form& form_of(Attribute attribute) {
    using enum Allowed;
    static const Form forms[] = {
        {"VEC3 of float (5126)", 3, 3, true, quantized, quantized, quantized, quantized},
        {"VEC3 of float (5126)", 3, 3, true, never, quantized, never, never},
        {"VEC4 of float (5126)", 4, 4, true, never, quantized, never, never},
        {"VEC2 of float (5126) or normalized unsigned byte or short", 2, 2, true, always, quantized,
         quantized, quantized},
        {"VEC3 or VEC4 of float (5126) or normalized unsigned byte or short", 3, 4, true, always,
         never, never, never},
        {"VEC4 of unsigned byte or short", 4, 4, false, never, never, always, never},
        {"VEC4 of float (5126) or normalized unsigned byte or short", 4, 4, true, always, never,
         never, never},
        {"VEC4 of float (5126) or normalized byte or short", 4, 4, true, always, always, never,
         never},
        {"SCALAR of float (5126) or normalized byte or short", 1, 1, true, always, always, never,
         never},
        {"SCALAR or VEC of at most 2 bytes or float (5126)", 1, 4, true, always, always, always,
         always}};
    return forms[static_cast<int>(attribute)];
}

// Whether an accessor may be read as a form; `quantized`: the file uses KHR_mesh_quantization.
bool fits(const tinygltf::Accessor& accessor, const Form& form, bool quantized) {
    const int type = accessor.componentType;
    const int components = tinygltf::GetNumComponentsInType(accessor.type);
    const bool is_vector =
        accessor.type <= TINYGLTF_TYPE_VEC4 || accessor.type == TINYGLTF_TYPE_SCALAR;
    if (!is_vector || components < form.fewest || components > form.most) return false;
    if (type == TINYGLTF_COMPONENT_TYPE_FLOAT) return form.floats;
    if (tinygltf::GetComponentSizeInBytes(type) > 2) return false;
    const bool is_signed =
        type == TINYGLTF_COMPONENT_TYPE_BYTE || type == TINYGLTF_COMPONENT_TYPE_SHORT;
    const Allowed allowed = accessor.normalized
                                ? (is_signed ? form.signed_fractions : form.fractions)
                                : (is_signed ? form.signed_integers : form.integers);
    return allowed == Allowed::always || (allowed == Allowed::quantized && quantized);
}

float component(const unsigned char* at, int type, bool normalized) {
    const auto scaled = [&](auto value, float largest) {
        const auto v = static_cast<float>(value);
        return normalized ? std::max(v / largest, -1.f) : v;
    };
    const auto read = [&](auto value) {
        std::memcpy(&value, at, sizeof(value));
        return value;
    };
    switch (type) {
        case TINYGLTF_COMPONENT_TYPE_BYTE:
            return scaled(read(std::int8_t{}), 127);
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
            return scaled(read(std::uint8_t{}), 255);
        case TINYGLTF_COMPONENT_TYPE_SHORT:
            return scaled(read(std::int16_t{}), 32767);
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
            return scaled(read(std::uint16_t{}), 65535);
        default:
            return read(float{});
    }
}

std::size_t element_bytes(const tinygltf::Accessor& accessor) {
    return static_cast<std::size_t>(tinygltf::GetComponentSizeInBytes(accessor.componentType)) *
           tinygltf::GetNumComponentsInType(accessor.type);
}

std::uint32_t unsigned_at(const unsigned char* data, int type, std::size_t i) {
    const auto bytes = static_cast<std::size_t>(tinygltf::GetComponentSizeInBytes(type));
    std::uint32_t value = 0;  // little-endian: low bytes first
    std::memcpy(&value, data + i * bytes, bytes);
    return value;
}

}  // namespace

Accessors::Accessors(const GltfFile& file, const tinygltf::Model& model)
    : file_(file),
      model_(model),
      quantized_(std::ranges::count(model.extensionsUsed, "KHR_mesh_quantization") > 0) {}

std::vector<unsigned char> Accessors::decompress(int view, const nlohmann::json& compressed) {
    const auto number = [&](const char* key) { return compressed.value(key, std::size_t{0}); };
    const std::vector<unsigned char>& buffer = model_.buffers[number("buffer")].data;
    const std::size_t count = number("count");
    const std::size_t stride = number("byteStride");
    const unsigned char* in = buffer.data() + number("byteOffset");
    const std::size_t length = number("byteLength");
    std::vector<unsigned char> out(count * stride);
    const std::string mode = compressed["mode"];
    const int failed =
        mode == "ATTRIBUTES"  ? meshopt_decodeVertexBuffer(out.data(), count, stride, in, length)
        : mode == "TRIANGLES" ? meshopt_decodeIndexBuffer(out.data(), count, stride, in, length)
                              : meshopt_decodeIndexSequence(out.data(), count, stride, in, length);
    if (failed != 0)
        throw InputError("{}: bufferViews[{}].extensions.{}: its {} bytes do not hold {} {}",
                         file_.path, view, compression_of(file_.json["bufferViews"][view]), length,
                         count, mode);
    const std::string filter = compressed.value("filter", "NONE");
    if (filter == "OCTAHEDRAL") meshopt_decodeFilterOct(out.data(), count, stride);
    if (filter == "QUATERNION") meshopt_decodeFilterQuat(out.data(), count, stride);
    if (filter == "EXPONENTIAL") meshopt_decodeFilterExp(out.data(), count, stride);
    return out;
}

std::span<const unsigned char> Accessors::view_bytes(int index) {
    const nlohmann::json& json = file_.json["bufferViews"][index];
    if (const char* compression = compression_of(json)) {
        const auto found = decompressed_.find(index);
        if (found != decompressed_.end()) return found->second;
        return decompressed_[index] = decompress(index, json["extensions"][compression]);
    }
    const tinygltf::BufferView& view = model_.bufferViews[index];
    return std::span(model_.buffers[view.buffer].data).subspan(view.byteOffset, view.byteLength);
}

// The elements that a sparse accessor has instead of those of its buffer view.
void Accessors::substitute(const tinygltf::Accessor& accessor, std::size_t bytes,
                           const std::string& where, std::vector<unsigned char>& out) {
    const auto& sparse = accessor.sparse;
    const unsigned char* places =
        view_bytes(sparse.indices.bufferView).data() + sparse.indices.byteOffset;
    const unsigned char* values =
        view_bytes(sparse.values.bufferView).data() + sparse.values.byteOffset;
    for (int i = 0; i < sparse.count; ++i) {
        const std::uint32_t place = unsigned_at(places, sparse.indices.componentType, i);
        if (place >= accessor.count)
            throw InputError("{}: {}: its sparse element {} is number {}, but there are {}",
                             file_.path, where, i, place, accessor.count);
        std::memcpy(out.data() + place * bytes, values + i * bytes, bytes);
    }
}

// Where an accessor's elements lie; its range was checked by check_gltf().
Accessors::Elements Accessors::elements(int index, const std::string& where) {
    const tinygltf::Accessor& accessor = model_.accessors[index];
    const std::size_t bytes = element_bytes(accessor);
    Elements in{nullptr, bytes, accessor.count, {}};
    const auto provided = provided_.find(index);
    if (provided != provided_.end()) {
        if (provided->second.size() != in.count * bytes)
            throw InputError("{}: {}: accessor {} is both indices and an attribute", file_.path,
                             where, index);
        in.data = provided->second.data();
        return in;
    }
    if (accessor.bufferView >= 0) {
        const std::size_t stride = model_.bufferViews[accessor.bufferView].byteStride;
        if (stride > 0) in.stride = stride;
        in.data = view_bytes(accessor.bufferView).data() + accessor.byteOffset;
        if (!accessor.sparse.isSparse) return in;
    }
    in.own.resize(in.count * bytes);  // zeros where there is no buffer view
    for (std::size_t i = 0; i < in.count && in.data != nullptr; ++i)
        std::memcpy(in.own.data() + i * bytes, in.data + i * in.stride, bytes);
    if (accessor.sparse.isSparse) substitute(accessor, bytes, where, in.own);
    in.data = in.own.data();
    in.stride = bytes;
    return in;
}

std::vector<glm::vec4> Accessors::vectors(int index, Attribute attribute,
                                          const std::string& where) {
    const tinygltf::Accessor& accessor = model_.accessors[index];
    const Form& form = form_of(attribute);
    if (!fits(accessor, form, quantized_))
        throw InputError("{}: {}: accessor {} is not {}", file_.path, where, index, form.name);
    const Elements in = elements(index, where);
    const int components = tinygltf::GetNumComponentsInType(accessor.type);
    const int bytes = tinygltf::GetComponentSizeInBytes(accessor.componentType);
    std::vector<glm::vec4> out(in.count, glm::vec4(1));
    for (std::size_t i = 0; i < in.count; ++i) {
        bool finite = true;
        const bool is_direction = attribute == Attribute::normal || attribute == Attribute::tangent;
        for (int c = 0; c < components; ++c) {
            out[i][c] = component(in.data + i * in.stride + c * bytes, accessor.componentType,
                                  accessor.normalized);
            finite = finite && std::isfinite(out[i][c]);
        }
        if (!finite && is_direction) {
            out[i] = glm::vec4(0, 0, 0, 1);
            notes_.add(where, "is not finite at some vertices; there it is left out");
        } else if (!finite)
            throw InputError("{}: {}: element {} ({}, {}, {}) is not finite", file_.path, where, i,
                             out[i].x, out[i].y, out[i].z);
    }
    return out;
}

std::vector<std::uint32_t> Accessors::indices(int index, const std::string& where) {
    const tinygltf::Accessor& accessor = model_.accessors[index];
    const int type = accessor.componentType;
    if (accessor.type != TINYGLTF_TYPE_SCALAR || (type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE &&
                                                  type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT &&
                                                  type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT))
        throw InputError("{}: {}: accessor {} is not SCALAR of an unsigned integer type",
                         file_.path, where, index);
    const Elements in = elements(index, where);
    std::vector<std::uint32_t> out(in.count);
    for (std::size_t i = 0; i < in.count; ++i)
        out[i] = unsigned_at(in.data + i * in.stride, type, 0);
    return out;
}

std::vector<glm::mat4> Accessors::matrices(int index, const std::string& where) {
    const tinygltf::Accessor& accessor = model_.accessors[index];
    if (accessor.type != TINYGLTF_TYPE_MAT4 ||
        accessor.componentType != TINYGLTF_COMPONENT_TYPE_FLOAT)
        throw InputError("{}: {}: accessor {} is not MAT4 of float (5126)", file_.path, where,
                         index);
    const Elements in = elements(index, where);
    std::vector<glm::mat4> out(in.count);
    for (std::size_t i = 0; i < in.count; ++i)
        std::memcpy(&out[i], in.data + i * in.stride, sizeof(glm::mat4));
    return out;
}

}  // namespace manylight

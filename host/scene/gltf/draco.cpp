// SPDX-License-Identifier: MIT
#include "scene/gltf/draco.hpp"

#include <draco/compression/mesh/mesh_edgebreaker_decoder.h>
#include <draco/compression/mesh/mesh_sequential_decoder.h>

#include <cstring>

#include "error.hpp"

namespace manylight {
namespace {

// Decodes no attributes that would take more than `most_bytes`: their number and size are the
// data's own.
template <class Decoder>
class BoundedDecoder : public Decoder {
  public:
    explicit BoundedDecoder(std::size_t most_bytes) : most_bytes_(most_bytes) {}

  protected:
    bool DecodeAllAttributes() override {
        const draco::PointCloud& points = *this->point_cloud();
        std::size_t bytes = 0;  // of a point: its values, and integers on the way to them
        for (int i = 0; i < points.num_attributes(); ++i) {
            const draco::PointAttribute& attribute = *points.attribute(i);
            bytes += static_cast<std::size_t>(attribute.num_components()) *
                     (draco::DataTypeLength(attribute.data_type()) + sizeof(std::int32_t));
        }
        return bytes <= most_bytes_ / std::max(points.num_points(), 1u) &&
               Decoder::DecodeAllAttributes();
    }

  private:
    std::size_t most_bytes_;
};

constexpr std::size_t header_bytes = 11;

// One compressed primitive. Source of the layout: Draco bitstream specification 2.2, sections 4
// (header), 5 (metadata) and 6 (connectivity).
class Primitive {
  public:
    Primitive(const GltfFile& file, const tinygltf::Model& model, Accessors& accessors,
              std::string where, const tinygltf::Primitive& primitive, const nlohmann::json& json)
        : file_(file),
          model_(model),
          accessors_(accessors),
          where_(std::move(where)),
          primitive_(primitive),
          json_(json) {}

    void decode() {
        vertices_ = model_.accessors[primitive_.attributes.at("POSITION")].count;
        triangles_ = model_.accessors[primitive_.indices].count / 3;
        const std::span<const unsigned char> stored = accessors_.view_bytes(json_["bufferView"]);
        check_header(stored);
        std::vector<unsigned char> without;
        std::span<const unsigned char> bytes = stored;
        if ((stored[10] & 0x80) != 0) bytes = without = without_metadata(stored);
        check_counts(bytes);
        if (bytes[8] == 1)
            decode_as<draco::MeshEdgebreakerDecoder>(bytes);
        else
            decode_as<draco::MeshSequentialDecoder>(bytes);
        check_counts(mesh_->num_points(), mesh_->num_faces());
        provide_indices();
        for (const auto& [name, id] : json_["attributes"].items()) {
            const auto found = primitive_.attributes.find(name);
            if (found != primitive_.attributes.end()) provide_attribute(name, id, found->second);
        }
    }

  private:
    template <class... T>
    [[noreturn]] void refuse(fmt::format_string<T...> format, T&&... values) const {
        throw InputError("{}: {}: {}", file_.path, where_,
                         fmt::format(format, std::forward<T>(values)...));
    }

    template <class Decoder>
    void decode_as(std::span<const unsigned char> bytes) {
        draco::DecoderBuffer buffer;
        buffer.Init(reinterpret_cast<const char*>(bytes.data()), bytes.size());
        mesh_ = std::make_unique<draco::Mesh>();
        BoundedDecoder<Decoder> decoder(16 * bytes.size() + (std::size_t{1} << 28));
        const draco::Status status = decoder.Decode(draco::DecoderOptions(), &buffer, mesh_.get());
        if (!status.ok())
            refuse("its Draco data cannot be decoded, or would need too much memory: {}",
                   status.error_msg_string());
    }

    void check_counts(std::size_t vertices, std::size_t triangles) const {
        if (triangles != triangles_)
            refuse("its data have {} triangles, but its indices are of {}", triangles, triangles_);
        if (vertices != vertices_)
            refuse("its data have {} vertices, but POSITION has {}", vertices, vertices_);
    }

    void check_header(std::span<const unsigned char> bytes) const {
        if (bytes.size() <= header_bytes || std::memcmp(bytes.data(), "DRACO", 5) != 0)
            refuse("bufferView {} holds no Draco data", json_["bufferView"].dump());
        const int version = bytes[5] * 256 + bytes[6];
        if (version != 0x202) refuse("Draco version {}.{} is not 2.2", bytes[5], bytes[6]);
        if (bytes[7] != 1) refuse("its Draco data are no mesh");
    }

    // A number of 7 bits a byte, low ones first; `at` moves behind it.
    std::uint64_t number(std::span<const unsigned char> bytes, std::size_t& at) const {
        std::uint64_t value = 0;
        for (int shift = 0; shift < 35; shift += 7) {
            if (at >= bytes.size()) refuse("its Draco data end early");
            value |= std::uint64_t{bytes[at] & 0x7fu} << shift;
            if ((bytes[at++] & 0x80) == 0) break;
        }
        return value;
    }

    // The same data without what they say about the mesh and its attributes, which shows nothing.
    [[nodiscard]] std::vector<unsigned char> without_metadata(
        std::span<const unsigned char> bytes) const {
        std::size_t at = header_bytes;
        const auto skip = [&](std::uint64_t count) {
            if (count > bytes.size() - at) refuse("its Draco data end early");
            at += count;
        };
        const auto skip_name = [&] {
            skip(1);
            skip(bytes[at - 1]);
        };
        const auto skip_metadata = [&] {
            std::uint64_t left = 1;  // one, and those below it, which have names
            for (bool is_first = true; left > 0; --left, is_first = false) {
                if (!is_first) skip_name();
                for (std::uint64_t entries = number(bytes, at); entries > 0; --entries) {
                    skip_name();
                    skip(number(bytes, at));
                }
                left += number(bytes, at);
            }
        };
        for (std::uint64_t attributes = number(bytes, at); attributes > 0; --attributes) {
            (void)number(bytes, at);  // its identifier
            skip_metadata();
        }
        skip_metadata();  // the mesh's
        std::vector<unsigned char> out(bytes.begin(), bytes.end());
        out[10] &= 0x7f;
        out.erase(out.begin() + header_bytes, out.begin() + static_cast<std::ptrdiff_t>(at));
        return out;
    }

    // Before anything is decoded, so that no data can ask for all memory.
    void check_counts(std::span<const unsigned char> bytes) const {
        const bool is_edgebreaker = bytes[8] == 1;
        std::size_t at = header_bytes + (is_edgebreaker ? 1 : 0);
        // Edgebreaker's vertices are those of the connectivity, of which several may be one.
        const std::uint64_t first = number(bytes, at);
        const std::uint64_t second = number(bytes, at);
        if (!is_edgebreaker) return check_counts(second, first);
        if (second != triangles_ || first > 3 * second)
            refuse("its data have {} triangles of {} vertices, but its indices are of {}", second,
                   first, triangles_);
    }

    void provide_indices() {
        const tinygltf::Accessor& accessor = model_.accessors[primitive_.indices];
        const int type = accessor.componentType;
        if (accessor.type != TINYGLTF_TYPE_SCALAR ||
            (type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE &&
             type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT &&
             type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT))
            refuse("accessor {} of its indices is not SCALAR of an unsigned integer type",
                   primitive_.indices);
        const std::size_t bytes = tinygltf::GetComponentSizeInBytes(type);
        if (bytes < 4 && vertices_ > std::size_t{1} << (8 * bytes))
            refuse("{} vertices do not fit indices of {} bytes", vertices_, bytes);
        std::vector<unsigned char> out(3 * triangles_ * bytes);
        for (std::size_t i = 0; i < 3 * triangles_; ++i) {
            const draco::FaceIndex face(static_cast<std::uint32_t>(i / 3));
            const std::uint32_t vertex = mesh_->face(face)[i % 3].value();
            std::memcpy(&out[i * bytes], &vertex, bytes);  // little-endian: low bytes first
        }
        accessors_.provide(primitive_.indices, std::move(out));
    }

    void provide_attribute(const std::string& name, std::uint32_t id, int index) {
        const draco::PointAttribute* attribute = mesh_->GetAttributeByUniqueId(id);
        if (attribute == nullptr) refuse("its data have no attribute {} for {}", id, name);
        const tinygltf::Accessor& accessor = model_.accessors[index];
        const int components = tinygltf::GetNumComponentsInType(accessor.type);
        if (attribute->num_components() != components)
            refuse("{} has {} components in its data, not {}", name, attribute->num_components(),
                   components);
        if (accessor.count != vertices_)
            refuse("{} has {} values for {} vertices", name, accessor.count, vertices_);
        switch (accessor.componentType) {
            case TINYGLTF_COMPONENT_TYPE_BYTE:
                return provide<std::int8_t>(*attribute, components, name, index);
            case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
                return provide<std::uint8_t>(*attribute, components, name, index);
            case TINYGLTF_COMPONENT_TYPE_SHORT:
                return provide<std::int16_t>(*attribute, components, name, index);
            case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
                return provide<std::uint16_t>(*attribute, components, name, index);
            case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
                return provide<std::uint32_t>(*attribute, components, name, index);
            default:
                return provide<float>(*attribute, components, name, index);
        }
    }

    template <class T>
    void provide(const draco::PointAttribute& attribute, int components, const std::string& name,
                 int accessor) {
        const std::size_t bytes = components * sizeof(T);
        std::vector<unsigned char> out(vertices_ * bytes);
        std::vector<T> value(components);
        for (std::size_t v = 0; v < vertices_; ++v) {
            const draco::PointIndex point(static_cast<std::uint32_t>(v));
            if (!attribute.ConvertValue<T>(attribute.mapped_index(point),
                                           static_cast<std::int8_t>(components), value.data()))
                refuse("value {} of {} does not fit the accessor's type", v, name);
            std::memcpy(&out[v * bytes], value.data(), bytes);
        }
        accessors_.provide(accessor, std::move(out));
    }

    const GltfFile& file_;
    const tinygltf::Model& model_;
    Accessors& accessors_;
    std::string where_;
    const tinygltf::Primitive& primitive_;
    const nlohmann::json& json_;
    std::size_t vertices_ = 0;
    std::size_t triangles_ = 0;
    std::unique_ptr<draco::Mesh> mesh_;
};

}  // namespace

void decode_draco(const GltfFile& file, const tinygltf::Model& model, int mesh,
                  Accessors& accessors) {
    const auto& primitives = model.meshes[mesh].primitives;
    for (std::size_t p = 0; p < primitives.size(); ++p) {
        const nlohmann::json& json = file.json["meshes"][mesh]["primitives"][p];
        if (!json.contains("extensions") || !json["extensions"].contains(draco_extension)) continue;
        Primitive(file, model, accessors,
                  fmt::format("meshes[{}].primitives[{}].extensions.{}", mesh, p, draco_extension),
                  primitives[p], json["extensions"][draco_extension])
            .decode();
    }
}

}  // namespace manylight

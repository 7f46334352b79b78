// SPDX-License-Identifier: MIT
#include <algorithm>

#include "scene/gltf/checking.hpp"

namespace manylight {
namespace {

constexpr std::uint64_t most_zeros = 1u << 24;

class DataChecker {
  public:
    explicit DataChecker(Checking& in) : in_(in) {}

    void check() {
        in_.each("buffers", [&](const JsonValue& object, std::size_t i) { buffer(object, i); });
        in_.each("bufferViews",
                 [&](const JsonValue& object, std::size_t i) { buffer_view(object, i); });
        find_draco_accessors();
        in_.each("accessors", [&](const JsonValue& object, std::size_t i) { accessor(object, i); });
    }

  private:
    void buffer(const JsonValue& buffer, std::size_t i) {
        (void)buffer["byteLength"].integer();
        if (!has_data(in_.file, i)) return;
        in_.stored += buffer["byteLength"].integer();
        if (buffer.has("uri")) in_.uri(buffer["uri"], true);
    }

    // The part of a buffer that `object` names; returns the buffer's index.
    std::size_t part_of_buffer(const JsonValue& object) {
        const std::size_t buffer = object["buffer"].index(in_.count("buffers"), "buffer");
        const std::uint64_t offset = object.has("byteOffset") ? object["byteOffset"].integer() : 0;
        const std::uint64_t length = object["byteLength"].integer();
        const std::uint64_t size = in_.root["buffers"].at(buffer)["byteLength"].integer();
        if (offset > size || length > size - offset)
            object.refuse("byteOffset {} and byteLength {} reach beyond buffer {} of {} bytes",
                          offset, length, buffer, size);
        return buffer;
    }

    void buffer_view(const JsonValue& view, std::size_t i) {
        const std::size_t buffer = part_of_buffer(view);
        if (view.has("extensions")) (void)view["extensions"].object();
        if (const char* compression = compression_of(in_.file.json["bufferViews"][i])) {
            compressed_view(view, view["extensions"][compression].object(), compression);
        } else if (!has_data(in_.file, buffer)) {
            view.refuse("buffer {} has no data", buffer);
        }
        if (view.has("byteStride")) {
            const std::uint64_t stride = view["byteStride"].integer();
            if (stride < 4 || stride > 252 || stride % 4 != 0)
                view["byteStride"].refuse("{} is no multiple of 4 within 4 and 252", stride);
        }
    }

    // EXT_meshopt_compression: what the decoder takes for granted, and what its data may grow to.
    void compressed_view(const JsonValue& view, const JsonValue& in, const char* compression) {
        const std::size_t buffer = part_of_buffer(in);
        if (!has_data(in_.file, buffer)) in["buffer"].refuse("buffer {} has no data", buffer);
        const std::string mode = in["mode"].one_of({"ATTRIBUTES", "TRIANGLES", "INDICES"});
        const std::string filter =
            in.has("filter")
                ? in["filter"].one_of({"NONE", "OCTAHEDRAL", "QUATERNION", "EXPONENTIAL"})
                : "NONE";
        const std::uint64_t stride = in["byteStride"].integer();
        const std::uint64_t elements = in["count"].integer();
        const bool attributes = mode == "ATTRIBUTES";
        const bool fits = attributes ? stride > 0 && stride % 4 == 0 && stride <= 256
                                     : stride == 2 || stride == 4;
        if (!fits) in["byteStride"].refuse("{} is no stride of {}", stride, mode);
        const bool filtered = filter == "NONE"         ? true
                              : filter == "OCTAHEDRAL" ? stride == 4 || stride == 8
                              : filter == "QUATERNION" ? stride == 8
                                                       : true;
        if (!attributes && filter != "NONE") in["filter"].refuse("{} cannot be filtered", mode);
        if (!filtered) in["byteStride"].refuse("{} is no stride of {}", stride, filter);
        if (mode == "TRIANGLES" && elements % 3 != 0)
            in["count"].refuse("{} is no whole number of triangles", elements);
        const std::uint64_t length = view["byteLength"].integer();
        if (elements == 0 || elements != length / stride || length % stride != 0)
            in["count"].refuse("{} elements of {} bytes are not the {} of the bufferView", elements,
                               stride, length);
        // 16 equal values of a byte take 2 bits.
        if (length / 64 > in["byteLength"].integer())
            in["byteLength"].refuse("{} bytes cannot hold {}", in["byteLength"].integer(), length);
        in_.decompress(length, in["byteLength"]);
        if (view.has("byteStride") && view["byteStride"].integer() != stride)
            view["byteStride"].refuse("{} is not {}'s {}", view["byteStride"].integer(),
                                      compression, stride);
    }

    static std::size_t component_bytes(const JsonValue& type) {
        switch (type.integer()) {
            case 5120:
            case 5121:
                return 1;
            case 5122:
            case 5123:
                return 2;
            case 5125:
            case 5126:
                return 4;
            default:
                type.refuse("{} is no component type", type.shown());
        }
    }

    void accessor(const JsonValue& accessor, std::size_t i) {
        const std::string type =
            accessor["type"].one_of({"SCALAR", "VEC2", "VEC3", "VEC4", "MAT2", "MAT3", "MAT4"});
        const std::size_t component = component_bytes(accessor["componentType"]);
        const std::size_t components = type == "SCALAR" ? 1
                                       : type == "MAT2" ? 4
                                       : type == "MAT3" ? 9
                                       : type == "MAT4" ? 16
                                                        : type.back() - '0';
        const std::uint64_t elements = accessor["count"].integer();
        for (const char* key : {"min", "max"})
            if (accessor.has(key)) accessor[key].numbers(components);
        if (accessor.has("normalized")) accessor["normalized"].boolean();
        if (accessor.has("sparse")) sparse(accessor, component * components);
        if (!accessor.has("bufferView")) {
            if (elements > most_zeros && !draco_accessors_.contains(i))
                accessor["count"].refuse("{} elements without a bufferView are more than {}",
                                         elements, most_zeros);
            return;
        }
        const std::size_t view = within_view(accessor, elements, component * components);
        const JsonValue buffer_view = in_.root["bufferViews"].at(view);
        if (buffer_view.has("byteStride") &&
            buffer_view["byteStride"].integer() < component * components)
            buffer_view["byteStride"].refuse("{} is less than the {} bytes of an element of {}",
                                             buffer_view["byteStride"].integer(),
                                             component * components, type);
    }

    // Elements in a buffer view; returns its index.
    std::size_t within_view(const JsonValue& object, std::uint64_t elements,
                            std::uint64_t element) {
        const std::size_t index =
            object["bufferView"].index(in_.count("bufferViews"), "bufferView");
        const JsonValue view = in_.root["bufferViews"].at(index);
        const std::uint64_t offset = object.has("byteOffset") ? object["byteOffset"].integer() : 0;
        const std::uint64_t length = view["byteLength"].integer();
        const std::uint64_t stride = std::max(
            view.has("byteStride") ? view["byteStride"].integer() : element, std::uint64_t{1});
        // offset + (elements - 1) stride + element <= length, without overflow
        if (offset > length ||
            (elements > 0 &&
             (element > length - offset || elements - 1 > (length - offset - element) / stride)))
            object.refuse("count {} at byteOffset {} reaches beyond bufferView {} of {} bytes",
                          elements, offset, index, length);
        return index;
    }

    void packed(const JsonValue& object, std::uint64_t elements, std::uint64_t element) {
        const std::size_t view = within_view(object, elements, element);
        if (in_.root["bufferViews"].at(view).has("byteStride"))
            object["bufferView"].refuse("bufferView {} of sparse elements has a byteStride", view);
    }

    void sparse(const JsonValue& accessor, std::uint64_t element) {
        const JsonValue sparse = accessor["sparse"].object();
        const std::uint64_t elements = sparse["count"].integer();
        if (elements == 0 || elements > accessor["count"].integer())
            sparse["count"].refuse("{} is not within 1 and the accessor's {}", elements,
                                   accessor["count"].integer());
        const JsonValue indices = sparse["indices"].object();
        for (const JsonValue& part : {indices, sparse["values"].object()})  // tinygltf's int
            if (part.has("byteOffset") && part["byteOffset"].integer() > 0x7fffffff)
                part["byteOffset"].refuse("{} is more than {}", part["byteOffset"].shown(),
                                          0x7fffffff);
        if (elements > 0x7fffffff)
            sparse["count"].refuse("{} is more than {}", elements, 0x7fffffff);
        const std::uint64_t type = indices["componentType"].integer();
        if (type != 5121 && type != 5123 && type != 5125)
            indices["componentType"].refuse("{} is no unsigned integer type", type);
        packed(indices, elements, component_bytes(indices["componentType"]));
        packed(sparse["values"].object(), elements, element);
    }

    // Those whose elements are in their primitive's data, which check_meshes() limits. Finds what
    // it can: check_meshes() judges.
    void find_draco_accessors() {
        if (!in_.root.has("meshes")) return;
        for (const nlohmann::json& mesh : in_.file.json["meshes"]) {
            if (!mesh.is_object() || !mesh.contains("primitives")) continue;
            for (const nlohmann::json& primitive : mesh["primitives"]) {
                const auto extended = nlohmann::json::json_pointer(
                    fmt::format("/extensions/{}/attributes", draco_extension));
                if (!primitive.is_object() || !primitive.contains(extended)) continue;
                if (primitive.contains("indices") && primitive["indices"].is_number_unsigned())
                    draco_accessors_.insert(primitive["indices"].get<std::uint64_t>());
                if (!primitive.contains("attributes") || !primitive["attributes"].is_object())
                    continue;
                for (const auto& [name, index] : primitive["attributes"].items())
                    if (primitive[extended].contains(name) && index.is_number_unsigned())
                        draco_accessors_.insert(index.get<std::uint64_t>());
            }
        }
    }

    Checking& in_;
    std::set<std::uint64_t> draco_accessors_;
};

}  // namespace

void check_data(Checking& in) { DataChecker(in).check(); }

}  // namespace manylight

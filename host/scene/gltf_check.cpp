// SPDX-License-Identifier: MIT
// The checks that the parsing library leaves out. One function per kind of object; each line states
// a rule of the glTF 2.0 specification or of a KHR extension.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>

#include "scene/gltf_extensions.hpp"
#include "scene/gltf_uri.hpp"
#include "scene/json_value.hpp"

namespace manylight {
namespace {

class Checker {
  public:
    explicit Checker(const GltfFile& file) : file_(file), root_(file.path, "", file.json) {}

    void check() {
        if (!file_.json.is_object())
            throw InputError("{}: JSON: {} is not an object", file_.path, root_.shown());
        asset();
        extensions();
        each("buffers", &Checker::buffer);
        each("bufferViews", &Checker::buffer_view);
        find_draco_accessors();
        each("accessors", &Checker::accessor);
        each("images", &Checker::image);
        each("samplers", &Checker::sampler);
        each("textures", &Checker::sampler_of);
        each("materials", &Checker::material);
        variant_names();
        each("meshes", &Checker::mesh);
        each("cameras", &Checker::camera);
        if (root_.has("extensions") && root_["extensions"].object().has(lights_extension)) {
            const JsonValue lights =
                root_["extensions"][lights_extension].object()["lights"].array();
            for (std::size_t i = 0; i < lights.size(); ++i) light(lights.at(i).object());
            light_count_ = lights.size();
        }
        each("skins", &Checker::skin);
        each("nodes", &Checker::node);
        each("animations", &Checker::animation);
        hierarchy();
        each("scenes", &Checker::scene);
        if (root_.has("scene")) (void)root_["scene"].index(count("scenes"), "scene");
    }

  private:
    static constexpr const char* lights_extension = "KHR_lights_punctual";
    static constexpr const char* instancing = "EXT_mesh_gpu_instancing";
    static constexpr const char* variants = "KHR_materials_variants";
    static constexpr const char* visibility = "KHR_node_visibility";
    static constexpr const char* emitter_points_key = "emitter_points";
    static constexpr std::uint64_t most_emitter_points = 1u << 24;
    static constexpr std::uint64_t most_coordinate_sets = 15;
    static constexpr std::uint64_t most_zeros = 1u << 24;
    static constexpr std::size_t none = ~std::size_t{0};

    [[nodiscard]] std::size_t count(const char* kind) const {
        return root_.has(kind) ? root_[kind].array().size() : 0;
    }

    void each(const char* kind, void (Checker::*check)(const JsonValue&, std::size_t)) {
        for (std::size_t i = 0; i < count(kind); ++i) (this->*check)(root_[kind].at(i).object(), i);
    }

    void optional_index(const JsonValue& object, const char* key, const char* kind,
                        const char* what) {
        if (object.has(key)) (void)object[key].index(count(kind), what);
    }

    void asset() {
        const JsonValue asset = root_["asset"].object();
        const JsonValue version = asset["version"];
        std::string digits = version.shown();  // some files of glTF 1.0 have a number there
        std::erase(digits, '"');
        if (digits == "1" || digits.starts_with("1.") || digits.starts_with("0."))
            version.refuse("{} is not 2.x; gltf-pipeline -i OLD -o NEW.glb converts it",
                           version.shown());
        if (!version.string().starts_with("2.")) version.refuse("{} is not 2.x", version.shown());
        if (asset.has("minVersion") && asset["minVersion"].string() != "2.0")
            asset["minVersion"].refuse("{} is newer than 2.0", asset["minVersion"].shown());
    }

    void extensions() {
        for (const char* key : {"extensionsUsed", "extensionsRequired"}) {
            if (!root_.has(key)) continue;
            const JsonValue names = root_[key].array();
            for (std::size_t i = 0; i < names.size(); ++i) {
                const std::string name = names.at(i).string();
                if (std::string_view(key) == "extensionsUsed") continue;
                if (name == "KHR_texture_basisu")
                    names.at(i).refuse(
                        "KTX2 textures of {} are not read; gltf-transform ktxdecompress OLD "
                        "NEW.glb "
                        "converts them",
                        name);
                if (extension_kind(name) == Extension::unknown)
                    names.at(i).refuse("the file cannot be rendered without {}, which is not known",
                                       name);
            }
        }
    }

    // A data URI, or a relative path that stays in the scene's folder.
    void uri(const JsonValue& value, bool must_exist) {
        const std::string text = value.string();
        if (text.starts_with("data:")) {
            const std::string head = text.substr(0, std::min(text.find(','), std::size_t{60}));
            if (!head.ends_with(";base64")) value.refuse("'{}': the data is not base64", head);
            if (must_exist && head != "data:application/octet-stream;base64" &&
                head != "data:application/gltf-buffer;base64")
                value.refuse("'{}' is no type of a buffer's data", head);
            return;
        }
        const std::filesystem::path file = file_of_uri(file_, text, value.where());
        std::error_code error;
        if (!must_exist) return;
        if (!std::filesystem::is_regular_file(file, error))
            value.refuse("{}: no such file beside the scene", value.shown());
        // Some thousands of buffers that name one file would be as many copies of it.
        if (!buffer_files_.insert(file).second)
            value.refuse("{} is another buffer's file too", value.shown());
    }

    void buffer(const JsonValue& buffer, std::size_t i) {
        (void)buffer["byteLength"].integer();
        if (!has_data(file_, i)) return;
        stored_ += buffer["byteLength"].integer();
        if (buffer.has("uri")) uri(buffer["uri"], true);
    }

    // The part of a buffer that `object` names; returns the buffer's index.
    std::size_t part_of_buffer(const JsonValue& object) {
        const std::size_t buffer = object["buffer"].index(count("buffers"), "buffer");
        const std::uint64_t offset = object.has("byteOffset") ? object["byteOffset"].integer() : 0;
        const std::uint64_t length = object["byteLength"].integer();
        const std::uint64_t size = root_["buffers"].at(buffer)["byteLength"].integer();
        if (offset > size || length > size - offset)
            object.refuse("byteOffset {} and byteLength {} reach beyond buffer {} of {} bytes",
                          offset, length, buffer, size);
        return buffer;
    }

    void buffer_view(const JsonValue& view, std::size_t i) {
        const std::size_t buffer = part_of_buffer(view);
        if (view.has("extensions")) (void)view["extensions"].object();
        if (const char* compression = compression_of(file_.json["bufferViews"][i])) {
            compressed_view(view, view["extensions"][compression].object(), compression);
        } else if (!has_data(file_, buffer)) {
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
        if (!has_data(file_, buffer)) in["buffer"].refuse("buffer {} has no data", buffer);
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
        decompressed_ += length;
        if (decompressed_ > most_decompressed())
            in["byteLength"].refuse("the file would decompress to more than {} bytes",
                                    most_decompressed());
        if (view.has("byteStride") && view["byteStride"].integer() != stride)
            view["byteStride"].refuse("{} is not {}'s {}", view["byteStride"].integer(),
                                      compression, stride);
    }

    [[nodiscard]] std::uint64_t most_decompressed() const {
        return 16 * stored_ + (std::uint64_t{1} << 28);
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
        const JsonValue buffer_view = root_["bufferViews"].at(view);
        if (buffer_view.has("byteStride") &&
            buffer_view["byteStride"].integer() < component * components)
            buffer_view["byteStride"].refuse("{} is less than the {} bytes of an element of {}",
                                             buffer_view["byteStride"].integer(),
                                             component * components, type);
    }

    // Elements in a buffer view; returns its index.
    std::size_t within_view(const JsonValue& object, std::uint64_t elements,
                            std::uint64_t element) {
        const std::size_t index = object["bufferView"].index(count("bufferViews"), "bufferView");
        const JsonValue view = root_["bufferViews"].at(index);
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
        if (root_["bufferViews"].at(view).has("byteStride"))
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

    void image(const JsonValue& image, std::size_t) {
        if (image.has("uri") && image.has("bufferView"))
            image.refuse("has both 'uri' and 'bufferView'");
        if (image.has("uri")) uri(image["uri"], false);
        if (!image.has("bufferView")) return;
        const std::size_t view = image["bufferView"].index(count("bufferViews"), "bufferView");
        if (compression_of(file_.json["bufferViews"][view]) != nullptr)
            image["bufferView"].refuse("bufferView {} is compressed, as no image can be", view);
    }

    void sampler_of(const JsonValue& texture, std::size_t) {
        optional_index(texture, "sampler", "samplers", "sampler");
    }

    // Of a texture that is rendered: others may name what is not there.
    void texture(const JsonValue& texture) {
        optional_index(texture, "source", "images", "image");
        if (!texture.has("extensions")) return;
        const JsonValue extensions = texture["extensions"].object();
        if (extensions.has("EXT_texture_webp"))
            optional_index(extensions["EXT_texture_webp"].object(), "source", "images", "image");
    }

    void sampler(const JsonValue& sampler, std::size_t) {
        const auto mode = [&](const char* key, const std::set<std::uint64_t>& allowed) {
            if (sampler.has(key) && !allowed.contains(sampler[key].integer()))
                sampler[key].refuse("{} is no {}", sampler[key].shown(), key);
        };
        mode("magFilter", {9728, 9729});
        mode("minFilter", {9728, 9729, 9984, 9985, 9986, 9987});
        for (const char* key : {"wrapS", "wrapT"}) mode(key, {10497, 33071, 33648});
    }

    void texture_coordinates(const JsonValue& object) {
        if (object.has("texCoord") && object["texCoord"].integer() > most_coordinate_sets)
            object["texCoord"].refuse("{} is more than {}", object["texCoord"].shown(),
                                      most_coordinate_sets);
    }

    void texture_info(const JsonValue& object, const char* key) {
        if (!object.has(key)) return;
        const JsonValue info = object[key].object();
        texture(root_["textures"].at(info["index"].index(count("textures"), "texture")));
        texture_coordinates(info);
        if (!info.has("extensions")) return;
        const JsonValue extensions = info["extensions"].object();
        if (!extensions.has("KHR_texture_transform")) return;
        const JsonValue moved = extensions["KHR_texture_transform"].object();
        for (const char* pair : {"offset", "scale"})
            if (moved.has(pair)) moved[pair].numbers(2);
        if (moved.has("rotation")) (void)moved["rotation"].number();
        texture_coordinates(moved);
    }

    void material(const JsonValue& material, std::size_t) {
        if (material.has("pbrMetallicRoughness")) {
            const JsonValue pbr = material["pbrMetallicRoughness"].object();
            if (pbr.has("baseColorFactor")) pbr["baseColorFactor"].colors(4);
            for (const char* key : {"metallicFactor", "roughnessFactor"})
                if (pbr.has(key)) (void)pbr[key].within(0, 1);
            texture_info(pbr, "baseColorTexture");
            texture_info(pbr, "metallicRoughnessTexture");
        }
        for (const char* key : {"normalTexture", "occlusionTexture", "emissiveTexture"})
            texture_info(material, key);
        if (material.has("normalTexture") && material["normalTexture"].has("scale"))
            (void)material["normalTexture"]["scale"].number();
        if (material.has("emissiveFactor")) {
            material["emissiveFactor"].numbers(3);
            for (std::size_t i = 0; i < 3; ++i)
                (void)material["emissiveFactor"].at(i).at_least_zero();
        }
        if (material.has("doubleSided")) material["doubleSided"].boolean();
        if (material.has("alphaMode"))
            (void)material["alphaMode"].one_of({"OPAQUE", "MASK", "BLEND"});
        if (material.has("alphaCutoff")) (void)material["alphaCutoff"].at_least_zero();
        if (material.has("extensions")) material_extensions(material["extensions"].object());
    }

    void material_extensions(const JsonValue& extensions) {
        if (extensions.has("KHR_materials_emissive_strength")) {
            const JsonValue strength = extensions["KHR_materials_emissive_strength"].object();
            if (strength.has("emissiveStrength"))
                (void)strength["emissiveStrength"].at_least_zero();
        }
        if (extensions.has("KHR_materials_ior")) {
            const JsonValue ior = extensions["KHR_materials_ior"].object();
            if (ior.has("ior") && ior["ior"].at_least_zero() != 0 && ior["ior"].number() < 1)
                ior["ior"].refuse("{} is neither 0 nor at least 1", ior["ior"].shown());
        }
        if (extensions.has("KHR_materials_specular")) {
            const JsonValue specular = extensions["KHR_materials_specular"].object();
            if (specular.has("specularFactor")) (void)specular["specularFactor"].within(0, 1);
            if (specular.has("specularColorFactor")) {
                const JsonValue color = specular["specularColorFactor"];
                color.numbers(3);
                for (std::size_t i = 0; i < 3; ++i) (void)color.at(i).at_least_zero();
            }
            texture_info(specular, "specularTexture");
            texture_info(specular, "specularColorTexture");
        }
        if (extensions.has("KHR_materials_pbrSpecularGlossiness")) {
            const JsonValue in = extensions["KHR_materials_pbrSpecularGlossiness"].object();
            if (in.has("diffuseFactor")) in["diffuseFactor"].colors(4);
            if (in.has("specularFactor")) in["specularFactor"].colors(3);
            if (in.has("glossinessFactor")) (void)in["glossinessFactor"].within(0, 1);
            texture_info(in, "diffuseTexture");
            texture_info(in, "specularGlossinessTexture");
        }
    }

    void mesh(const JsonValue& mesh, std::size_t) {
        const JsonValue primitives = mesh["primitives"].array();
        if (primitives.size() == 0) primitives.refuse("a mesh has at least one primitive");
        if (mesh.has("weights")) mesh["weights"].numbers(mesh["weights"].array().size());
        for (std::size_t i = 0; i < primitives.size(); ++i) {
            const JsonValue primitive = primitives.at(i).object();
            const JsonValue attributes = primitive["attributes"].object();
            for (const std::string& name : attributes.keys())
                if (!name.starts_with("TEXCOORD_"))  // see mend_gltf()
                    (void)attributes[name.c_str()].index(count("accessors"), "accessor");
            optional_index(primitive, "indices", "accessors", "accessor");
            optional_index(primitive, "material", "materials", "material");
            if (primitive.has("mode") && primitive["mode"].integer() > 6)
                primitive["mode"].refuse("{} is no primitive mode", primitive["mode"].shown());
            if (primitive.has("extensions") &&
                primitive["extensions"].object().has(draco_extension))
                draco(primitive, primitive["extensions"][draco_extension].object());
            if (primitive.has("extensions") && primitive["extensions"].object().has(variants))
                mappings(primitive["extensions"][variants].object());
            if (!primitive.has("targets")) continue;
            const JsonValue targets = primitive["targets"].array();
            for (std::size_t t = 0; t < targets.size(); ++t)
                for (const std::string& name : targets.at(t).object().keys())
                    (void)targets.at(t)[name.c_str()].index(count("accessors"), "accessor");
        }
    }

    // KHR_materials_variants: the variants, and a primitive's materials for them.
    void variant_names() {
        if (!root_.has("extensions") || !root_["extensions"].object().has(variants)) return;
        const JsonValue names = root_["extensions"][variants].object()["variants"].array();
        for (std::size_t i = 0; i < names.size(); ++i) (void)names.at(i).object()["name"].string();
        variant_count_ = names.size();
    }

    void mappings(const JsonValue& in) {
        const JsonValue mappings = in["mappings"].array();
        for (std::size_t i = 0; i < mappings.size(); ++i) {
            const JsonValue mapping = mappings.at(i).object();
            (void)mapping["material"].index(count("materials"), "material");
            const JsonValue chosen = mapping["variants"].array();
            for (std::size_t v = 0; v < chosen.size(); ++v)
                (void)chosen.at(v).index(variant_count_, "variant");
        }
    }

    // Those whose elements are in their primitive's data, which draco() limits. Finds what it can:
    // mesh() judges.
    void find_draco_accessors() {
        if (!root_.has("meshes")) return;
        for (const nlohmann::json& mesh : file_.json["meshes"]) {
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

    // KHR_draco_mesh_compression: what decoding takes for granted, and what it may grow to.
    void draco(const JsonValue& primitive, const JsonValue& in) {
        if (primitive.has("mode") && primitive["mode"].integer() != 4)
            primitive["mode"].refuse("{} cannot be compressed; 4 can", primitive["mode"].shown());
        (void)in["bufferView"].index(count("bufferViews"), "bufferView");
        const JsonValue ids = in["attributes"].object();
        for (const std::string& name : ids.keys())
            if (ids[name.c_str()].integer() > 0xffffffffu)
                ids[name.c_str()].refuse("{} is no attribute", ids[name.c_str()].shown());
        const JsonValue attributes = primitive["attributes"].object();
        const auto count_of = [&](const JsonValue& accessor) {
            return root_["accessors"].at(accessor.index(count("accessors"), "accessor"))["count"];
        };
        const JsonValue corners = count_of(primitive["indices"]);
        if (corners.integer() % 3 != 0)
            corners.refuse("{} corners are no whole number of triangles", corners.shown());
        // At the least: a triangle's corners in three tables, a position's numbers in two.
        decompressed_ += 12 * corners.integer() + 24 * count_of(attributes["POSITION"]).integer();
        if (decompressed_ > most_decompressed())
            in.refuse("the file would decompress to more than {} bytes", most_decompressed());
    }

    void camera(const JsonValue& camera, std::size_t) {
        const std::string type = camera["type"].one_of({"perspective", "orthographic"});
        const JsonValue lens = camera[type.c_str()].object();
        if (type == "perspective") {
            if (lens["yfov"].positive() >= M_PI)
                lens["yfov"].refuse("{} is not below pi", lens["yfov"].shown());
            if (lens.has("aspectRatio")) (void)lens["aspectRatio"].positive();
            (void)lens["znear"].positive();
            if (lens.has("zfar")) check_far(lens);
        } else {
            for (const char* key : {"xmag", "ymag"})
                if (lens[key].number() == 0) lens[key].refuse("0 is no size");
            (void)lens["znear"].at_least_zero();
            check_far(lens);
        }
    }

    static void check_far(const JsonValue& lens) {
        if (lens["zfar"].number() <= lens["znear"].number())
            lens["zfar"].refuse("{} is not above znear, {}", lens["zfar"].shown(),
                                lens["znear"].shown());
    }

    void light(const JsonValue& light) {
        const std::string type = light["type"].one_of({"point", "spot", "directional"});
        if (light.has("color")) {
            light["color"].numbers(3);
            for (std::size_t i = 0; i < 3; ++i) (void)light["color"].at(i).at_least_zero();
        }
        if (light.has("intensity")) (void)light["intensity"].at_least_zero();
        if (light.has("range")) (void)light["range"].positive();
        if (type != "spot") return;
        const JsonValue spot = light["spot"].object();
        const double outer =
            spot.has("outerConeAngle") ? spot["outerConeAngle"].positive() : M_PI_4;
        const double inner =
            spot.has("innerConeAngle") ? spot["innerConeAngle"].at_least_zero() : 0;
        if (outer > 1.5707964) spot["outerConeAngle"].refuse("{} is more than pi / 2", outer);
        // Equal ones are forbidden too, but that is how Blender exports sharp spots.
        if (inner > outer)
            spot.refuse("innerConeAngle {} is more than outerConeAngle {}", inner, outer);
    }

    void skin(const JsonValue& skin, std::size_t) {
        const JsonValue joints = skin["joints"].array();
        for (std::size_t i = 0; i < joints.size(); ++i)
            (void)joints.at(i).index(count("nodes"), "node");
        optional_index(skin, "inverseBindMatrices", "accessors", "accessor");
        optional_index(skin, "skeleton", "nodes", "node");
    }

    void animation(const JsonValue& animation, std::size_t) {
        const JsonValue samplers = animation["samplers"].array();
        for (std::size_t i = 0; i < samplers.size(); ++i) {
            for (const char* key : {"input", "output"})
                (void)samplers.at(i).object()[key].index(count("accessors"), "accessor");
            if (samplers.at(i).has("interpolation"))
                (void)samplers.at(i)["interpolation"].one_of({"LINEAR", "STEP", "CUBICSPLINE"});
        }
        const JsonValue channels = animation["channels"].array();
        for (std::size_t i = 0; i < channels.size(); ++i) {
            (void)channels.at(i).object()["sampler"].index(samplers.size(), "sampler");
            optional_index(channels.at(i)["target"].object(), "node", "nodes", "node");
        }
    }

    void node(const JsonValue& node, std::size_t) {
        optional_index(node, "mesh", "meshes", "mesh");
        optional_index(node, "camera", "cameras", "camera");
        optional_index(node, "skin", "skins", "skin");
        if (node.has("matrix")) {
            node["matrix"].numbers(16);
            for (const char* key : {"translation", "rotation", "scale"})
                if (node.has(key)) node.refuse("has both 'matrix' and '{}'", key);
        }
        if (node.has("translation")) node["translation"].numbers(3);
        if (node.has("scale")) node["scale"].numbers(3);
        if (node.has("rotation")) {
            const JsonValue rotation = node["rotation"];
            rotation.numbers(4);
            double squared = 0;
            for (std::size_t i = 0; i < 4; ++i) squared += std::pow(rotation.at(i).number(), 2);
            // Beyond that it is more likely something else than a rotation printed with few digits.
            if (std::abs(std::sqrt(squared) - 1) > 0.1)
                rotation.refuse("{} is not a unit quaternion", rotation.shown());
        }
        if (node.has("weights")) node["weights"].numbers(node["weights"].array().size());
        if (!node.has("extensions")) return;
        const JsonValue extensions = node["extensions"].object();
        if (extensions.has(visibility) && extensions[visibility].object().has("visible"))
            extensions[visibility]["visible"].boolean();
        if (extensions.has(lights_extension))
            (void)extensions[lights_extension].object()["light"].index(light_count_, "light");
        if (!extensions.has(instancing)) return;
        const JsonValue attributes = extensions[instancing].object()["attributes"].object();
        for (const std::string& name : attributes.keys())
            (void)attributes[name.c_str()].index(count("accessors"), "accessor");
    }

    // Every node has at most one parent, and none is its own ancestor.
    void hierarchy() {
        std::vector<std::size_t> parent(count("nodes"), none);
        for (std::size_t i = 0; i < parent.size(); ++i) {
            const JsonValue node = root_["nodes"].at(i);
            if (!node.has("children")) continue;
            const JsonValue children = node["children"].array();
            for (std::size_t c = 0; c < children.size(); ++c) {
                const std::size_t child = children.at(c).index(parent.size(), "node");
                if (parent[child] != none)
                    children.at(c).refuse("node {} is already a child of node {}", child,
                                          parent[child]);
                parent[child] = i;
            }
        }
        std::vector<bool> rooted(parent.size(), false);
        for (std::size_t i = 0; i < parent.size(); ++i) {
            std::vector<std::size_t> path;
            std::size_t node = i;
            for (; node != none && !rooted[node]; node = parent[node]) {
                if (path.size() > parent.size()) root_["nodes"].at(i).refuse("is its own ancestor");
                path.push_back(node);
            }
            for (const std::size_t n : path) rooted[n] = true;
        }
    }

    void scene(const JsonValue& scene, std::size_t) {
        extras(scene);
        if (!scene.has("nodes")) return;
        const JsonValue nodes = scene["nodes"].array();
        for (std::size_t i = 0; i < nodes.size(); ++i)
            (void)nodes.at(i).index(count("nodes"), "node");
    }

    void extras(const JsonValue& scene) {
        if (!scene.has("extras")) return;
        const JsonValue extras = scene["extras"];
        if (!extras.keys().empty() && extras.has(emitter_points_key) &&
            extras[emitter_points_key].integer() > most_emitter_points)
            extras[emitter_points_key].refuse(
                "{} is more than {}", extras[emitter_points_key].shown(), most_emitter_points);
    }

    const GltfFile& file_;
    JsonValue root_;
    std::size_t light_count_ = 0;
    std::size_t variant_count_ = 0;
    std::uint64_t stored_ = 0;        // bytes of buffers
    std::uint64_t decompressed_ = 0;  // bytes, so far
    std::set<std::filesystem::path> buffer_files_;
    std::set<std::uint64_t> draco_accessors_;
};

}  // namespace

constexpr const char* meshopt_extensions[] = {"EXT_meshopt_compression", "KHR_meshopt_compression"};

const char* compression_of(const nlohmann::json& view) {
    const auto extensions = view.find("extensions");
    if (extensions == view.end()) return nullptr;
    for (const char* name : meshopt_extensions)
        if (extensions->contains(name)) return name;
    return nullptr;
}

bool has_data(const GltfFile& file, std::size_t index) {
    const nlohmann::json& buffer = file.json["buffers"][index];
    for (const char* extension : meshopt_extensions) {
        const nlohmann::json::json_pointer fallback(
            fmt::format("/extensions/{}/fallback", extension));
        if (buffer.contains(fallback) && buffer[fallback] == true) return false;
    }
    return buffer.contains("uri") || (index == 0 && file.binary);
}

void check_gltf(const GltfFile& file) { Checker(file).check(); }

}  // namespace manylight

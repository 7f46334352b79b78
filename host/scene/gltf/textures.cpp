// SPDX-License-Identifier: MIT
#include "scene/gltf/textures.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <span>

#include "error.hpp"
#include "scene/gltf/uri.hpp"
#include "scene/textures.hpp"

namespace manylight {
namespace {

using nlohmann::json;

const json& member(const json& object, const char* key) {
    static const json none = json::object();
    const auto found = object.find(key);
    return found == object.end() ? none : *found;
}

// The JSON was checked by check_gltf().
class Textures {
  public:
    Textures(const GltfFile& file, const tinygltf::Model& model, std::size_t most_bytes,
             Scene& scene, Notes& notes)
        : file_(file), model_(model), most_bytes_(most_bytes), scene_(scene), notes_(notes) {}

    void add_material(const json& material, std::size_t index) {
        const json& pbr = member(material, "pbrMetallicRoughness");
        const bool opaque = material.value("alphaMode", "OPAQUE") == "OPAQUE";
        add_map(index, MAP_BASE_COLOR, member(pbr, "baseColorTexture"),
                {.color = true, .weighted = !opaque});
        add_map(index, MAP_METALLIC_ROUGHNESS, member(pbr, "metallicRoughnessTexture"), {});
        add_map(index, MAP_NORMAL, member(material, "normalTexture"), {});
        if (scene_.materials[index].unlit) return;
        add_map(index, MAP_EMISSION, member(material, "emissiveTexture"), {.color = true});
        const json& extensions = member(material, "extensions");
        const json& glossy = member(extensions, "KHR_materials_pbrSpecularGlossiness");
        add_map(index, MAP_METALLIC_ROUGHNESS, member(glossy, "specularGlossinessTexture"),
                {.glossiness = glossy.value("glossinessFactor", 1.f)});
        const json& specular = member(extensions, "KHR_materials_specular");
        add_map(index, MAP_SPECULAR, member(specular, "specularTexture"), {});
        add_map(index, MAP_SPECULAR_COLOR, member(specular, "specularColorTexture"),
                {.color = true});
    }

    [[nodiscard]] std::vector<unsigned> sets() const { return sets_; }

  private:
    void add_map(std::size_t material, MapKind kind, const json& info, TexelMeaning meaning) {
        if (!info.contains("index")) return;
        const json& texture = file_.json["textures"][info["index"].get<std::size_t>()];
        const std::optional<std::size_t> image = image_of(texture);
        if (!image) notes_.add(fmt::format("textures[{}]", info["index"].dump()), without_image);
        if (!image || !is_there(*image)) return stand_in(scene_.materials[material], kind);
        if (scene_.maps.empty()) {
            TextureMap none{};
            none.texture = NO_TEXTURE;
            scene_.maps.assign(MAP_KIND_COUNT * scene_.materials.size(), none);
        }
        TextureMap& map = scene_.maps[MAP_KIND_COUNT * material + kind];
        map = transform(member(member(info, "extensions"), "KHR_texture_transform"));
        const json& moved = member(member(info, "extensions"), "KHR_texture_transform");
        map.set = set_of(moved.value("texCoord", info.value("texCoord", 0u)));
        map.scale = info.value("scale", 1.f);
        map.texture = static_cast<uint>(scene_.textures.size());
        scene_.textures.push_back(with_sampler(texels_of(*image, meaning), texture));
    }

    // Of what says how much a surface gives or is, nothing; otherwise the material's own factor.
    static void stand_in(Material& material, MapKind kind) {
        if (kind == MAP_EMISSION) material.emission = float4(glm::vec3(0), material.emission.w);
        if (kind == MAP_METALLIC_ROUGHNESS) material.base_color.w = 0;
    }

    [[nodiscard]] bool is_there(std::size_t image) const {
        const json& object = file_.json["images"][image];
        const std::string place = fmt::format("images[{}]", image);
        if (object.contains("bufferView")) return true;
        if (!object.contains("uri")) {
            notes_.add(place, without_image);
            return false;
        }
        const std::string& uri = object["uri"].get_ref<const std::string&>();
        std::error_code error;
        if (uri.starts_with("data:") ||
            std::filesystem::exists(file_of_uri(file_, uri, place), error))
            return true;
        notes_.add(fmt::format("{}.uri: '{}'", place, uri), without_file);
        return false;
    }

    // Scaled, then turned, counter-clockwise where v points down as images do, then moved: as
    // the glTF sample viewer and Blender take the extension.
    static TextureMap transform(const json& moved) {
        const auto offset = moved.value("offset", std::vector<double>{0, 0});
        const auto scale = moved.value("scale", std::vector<double>{1, 1});
        const double angle = moved.value("rotation", 0.0);
        TextureMap map{};
        map.u = float4(std::cos(angle) * scale[0], std::sin(angle) * scale[1], offset[0], 0);
        map.v = float4(-std::sin(angle) * scale[0], std::cos(angle) * scale[1], offset[1], 0);
        return map;
    }

    // The image of a texture; WebP has an extension, beside which there may be another for those
    // who cannot read it.
    static std::optional<std::size_t> image_of(const json& texture) {
        const json& webp = member(member(texture, "extensions"), "EXT_texture_webp");
        if (webp.contains("source")) return webp["source"].get<std::size_t>();
        if (texture.contains("source")) return texture["source"].get<std::size_t>();
        return {};
    }

    uint set_of(unsigned number) {
        const auto found = std::ranges::find(sets_, number);
        const auto set = static_cast<uint>(found - sets_.begin());
        if (found == sets_.end()) {
            sets_.push_back(number);
            scene_.coordinates.emplace_back();
        }
        return set;
    }

    Texture with_sampler(Texture out, const json& texture) const {
        static const json defaults = json::object();
        const json& sampler = texture.contains("sampler")
                                  ? file_.json["samplers"][texture["sampler"].get<std::size_t>()]
                                  : defaults;
        const auto wrap = [&](const char* key) -> uint {
            const int mode = sampler.value(key, 10497);
            return mode == 33071 ? WRAP_CLAMP : mode == 33648 ? WRAP_MIRROR : WRAP_REPEAT;
        };
        out.wrap_u = wrap("wrapS");
        out.wrap_v = wrap("wrapT");
        out.magnified_linear = sampler.value("magFilter", 9729) == 9729;
        const int minified = sampler.value("minFilter", 9987);
        out.minified_linear = minified % 2;  // 9729, 9985 and 9987 are LINEAR...
        out.between = minified < 9984   ? LEVELS_FINEST
                      : minified < 9986 ? LEVELS_NEAREST
                                        : LEVELS_BLENDED;
        return out;
    }

    // Every image is kept once for each meaning.
    Texture texels_of(std::size_t image, TexelMeaning meaning) {
        const auto key = std::pair(image, meaning);
        const auto known = texels_.find(key);
        if (known != texels_.end()) return known->second;
        const std::string where = fmt::format("{}: images[{}]", file_.path, image);
        const std::vector<unsigned char> bytes = bytes_of(image, where);
        DecodedImage decoded = decode_image(bytes, where);
        if (meaning.glossiness >= 0) {
            make_roughness(decoded.bytes, 255, meaning.glossiness);
            make_roughness(decoded.floats, 1, meaning.glossiness);
        }
        refuse_beyond_memory(decoded, where);
        const Texture texture = add_texels(scene_, decoded, meaning, where);
        return texels_.emplace(key, texture).first->second;
    }

    // Roughness to G, of no metal, from glossiness in A.
    template <class T>
    static void make_roughness(std::vector<T>& texels, float one, float factor) {
        for (std::size_t i = 0; i < texels.size(); i += 4) {
            const float roughness = one - factor * static_cast<float>(texels[i + 3]);
            texels[i + 1] = static_cast<T>(one == 1 ? roughness : std::round(roughness));
            texels[i + 2] = 0;
        }
    }

    // A few kilobytes may hold an image of any size, and a file any number of them.
    void refuse_beyond_memory(const DecodedImage& image, const std::string& where) const {
        const double words = image.bytes.empty() ? 2 : 1;
        const double finest = words * image.width * image.height;
        const double bytes = 4 * (static_cast<double>(scene_.texels.size()) + finest * 4 / 3);
        constexpr double gib = 1 << 30;
        if (bytes > static_cast<double>(most_bytes_))
            throw InputError(
                "{}: with it the scene's textures need {:.1f} GiB, and there are {:.1f} GiB of "
                "memory",
                where, bytes / gib, static_cast<double>(most_bytes_) / gib);
    }

    [[nodiscard]] std::vector<unsigned char> bytes_of(std::size_t image, const std::string& where) {
        const json& object = file_.json["images"][image];
        if (object.contains("bufferView")) {
            const auto& view = model_.bufferViews[object["bufferView"].get<std::size_t>()];
            const auto& data = model_.buffers[static_cast<std::size_t>(view.buffer)].data;
            const auto* begin = data.data() + view.byteOffset;
            return {begin, begin + view.byteLength};
        }
        const std::string& uri = object["uri"].get_ref<const std::string&>();
        return bytes_of_uri(file_, uri, where + ".uri");
    }

    static constexpr const char* without_image =
        "has no image that is read; it is left out (emission and metal are 0)";
    static constexpr const char* without_file =
        "is no file beside the scene; it is left out (emission and metal are 0)";

    const GltfFile& file_;
    const tinygltf::Model& model_;
    std::size_t most_bytes_;
    Scene& scene_;
    Notes& notes_;
    std::vector<unsigned> sets_;
    std::map<std::pair<std::size_t, TexelMeaning>, Texture> texels_;
};

}  // namespace

std::vector<unsigned> load_textures(const GltfFile& file, const tinygltf::Model& model,
                                    const std::vector<bool>& used, std::size_t most_bytes,
                                    Scene& scene, Notes& notes) {
    Textures textures(file, model, most_bytes, scene, notes);
    const json& materials = member(file.json, "materials");
    for (std::size_t i = 0; i < materials.size(); ++i)
        if (used[i]) textures.add_material(materials[i], i);
    return textures.sets();
}

}  // namespace manylight

// SPDX-License-Identifier: MIT
#include "scene/gltf/checking.hpp"

namespace manylight {
namespace {

constexpr std::uint64_t most_coordinate_sets = 15;

class MaterialChecker {
  public:
    explicit MaterialChecker(Checking& in) : in_(in) {}

    void check() {
        in_.each("images", [&](const JsonValue& object, std::size_t) { image(object); });
        in_.each("samplers", [&](const JsonValue& object, std::size_t) { sampler(object); });
        in_.each("textures", [&](const JsonValue& object, std::size_t) { sampler_of(object); });
        in_.each("materials", [&](const JsonValue& object, std::size_t) { material(object); });
    }

  private:
    void image(const JsonValue& image) {
        if (image.has("uri") && image.has("bufferView"))
            image.refuse("has both 'uri' and 'bufferView'");
        if (image.has("uri")) in_.uri(image["uri"], false);
        if (!image.has("bufferView")) return;
        const std::size_t view = image["bufferView"].index(in_.count("bufferViews"), "bufferView");
        if (compression_of(in_.file.json["bufferViews"][view]) != nullptr)
            image["bufferView"].refuse("bufferView {} is compressed, as no image can be", view);
    }

    void sampler_of(const JsonValue& texture) {
        in_.optional_index(texture, "sampler", "samplers", "sampler");
    }

    // Of a texture that is rendered: others may name what is not there.
    void texture(const JsonValue& texture) {
        in_.optional_index(texture, "source", "images", "image");
        if (!texture.has("extensions")) return;
        const JsonValue extensions = texture["extensions"].object();
        if (extensions.has("EXT_texture_webp"))
            in_.optional_index(extensions["EXT_texture_webp"].object(), "source", "images",
                               "image");
    }

    void sampler(const JsonValue& sampler) {
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
        texture(in_.root["textures"].at(info["index"].index(in_.count("textures"), "texture")));
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

    void material(const JsonValue& material) {
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

    Checking& in_;
};

}  // namespace

void check_materials(Checking& in) { MaterialChecker(in).check(); }

}  // namespace manylight

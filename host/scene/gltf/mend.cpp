// SPDX-License-Identifier: MIT
// What glTF forbids and yet has one sensible reading is changed to that reading; extensions that
// say the same as glTF itself are put into its words.
#include "scene/gltf/mend.hpp"

#include <algorithm>
#include <cmath>

#include "error.hpp"

namespace manylight {
namespace {

using nlohmann::json;

constexpr const char* visibility = "KHR_node_visibility";
constexpr const char* variants = "KHR_materials_variants";
constexpr const char* glossiness = "KHR_materials_pbrSpecularGlossiness";

json* extension_of(json& object, const char* name) {
    const json::json_pointer place = json::json_pointer("/extensions") / name;
    return object.contains(place) ? &object[place] : nullptr;
}

// The JSON was checked by check_gltf().
class Mender {
  public:
    explicit Mender(GltfFile& file) : file_(file), json_(file.json) {}

    void mend(const std::string& variant) {
        find_parents();
        if (!json_.contains("scenes") || json_["scenes"].empty()) add_scene();
        list_nodes_once();
        make_rotations_unit();
        note_bright_emission();
        note_textures_without_image();
        note_empty_data();
        take_out_coordinates_without_accessor();
        hide_nodes();
        if (!variant.empty()) choose_variant(variant);
        if (json_.contains("materials"))
            for (json& material : json_["materials"]) convert_glossiness(material);
    }

  private:
    static constexpr std::size_t none = ~std::size_t{0};

    void find_parents() {
        parent_.assign(json_.contains("nodes") ? json_["nodes"].size() : 0, none);
        for (std::size_t i = 0; i < parent_.size(); ++i)
            if (json_["nodes"][i].contains("children"))
                for (const json& child : json_["nodes"][i]["children"])
                    parent_[child.get<std::size_t>()] = i;
    }

    // A file without a scene is shown whole.
    void add_scene() {
        json roots = json::array();
        for (std::size_t i = 0; i < parent_.size(); ++i)
            if (parent_[i] == none) roots.push_back(i);
        json_["scenes"] = {{{"nodes", roots}}};
    }

    // In the scene that is shown: each with what is below it. A node stays where its parents put
    // it, whether they are listed or not.
    void list_nodes_once() {
        const auto shown = json_.value("scene", std::size_t{0});
        json& scene = json_["scenes"][shown];
        if (!scene.contains("nodes")) return;
        json& nodes = scene["nodes"];
        std::vector<bool> is_done = below(nodes);
        json kept = json::array();
        for (std::size_t i = 0; i < nodes.size(); ++i) {
            const auto node = nodes[i].get<std::size_t>();
            if (parent_[node] != none || is_done[node])
                file_.notes.add(fmt::format("scenes[{}].nodes[{}]", shown, i),
                                "is no root, or listed twice; every node is shown once");
            if (!is_done[node]) kept.push_back(node);
            is_done[node] = true;
        }
        nodes = kept;
    }

    // [node] whether it is below one of those.
    [[nodiscard]] std::vector<bool> below(const json& nodes) const {
        std::vector<bool> out(parent_.size(), false);
        std::vector<std::size_t> open;
        for (const json& node : nodes) open.push_back(node.get<std::size_t>());
        while (!open.empty()) {
            const json& node = json_["nodes"][open.back()];
            open.pop_back();
            if (!node.contains("children")) continue;
            for (const json& child : node["children"]) {
                const auto c = child.get<std::size_t>();
                if (!out[c]) open.push_back(c);
                out[c] = true;
            }
        }
        return out;
    }

    void make_rotations_unit() {
        constexpr double rounding = 1e-3;  // that exporters print with
        for (std::size_t i = 0; i < parent_.size(); ++i) {
            const json& node = json_["nodes"][i];
            if (!node.contains("rotation")) continue;
            double squared = 0;
            for (const json& part : node["rotation"]) squared += std::pow(part.get<double>(), 2);
            if (std::abs(std::sqrt(squared) - 1) > rounding)
                file_.notes.add(fmt::format("nodes[{}].rotation", i),
                                "is no unit quaternion; it is divided by its length");
        }
    }

    void note_bright_emission() {
        for_each("materials", [&](const json& material, const std::string& place) {
            if (!material.contains("emissiveFactor")) return;
            for (const json& part : material["emissiveFactor"])
                if (part.get<double>() > 1)
                    file_.notes.add(place + ".emissiveFactor",
                                    "is above 1; it is taken as it is, in cd/m2");
        });
    }

    void note_textures_without_image() {
        const std::size_t images = json_.contains("images") ? json_["images"].size() : 0;
        for_each("textures", [&](const json& texture, const std::string& place) {
            if (!texture.contains("source")) return;
            const json& source = texture["source"];
            if (!source.is_number_unsigned() || source.get<std::size_t>() >= images)
                file_.notes.add(place + ".source",
                                "is no image; nothing that is rendered uses the texture");
        });
    }

    void note_empty_data() {
        for (const char* kind : {"buffers", "bufferViews"})
            for_each(kind, [&](const json& bytes, const std::string& place) {
                if (bytes["byteLength"] == 0)
                    file_.notes.add(place + ".byteLength", "is 0; nothing is there");
            });
        for_each("accessors", [&](const json& accessor, const std::string& place) {
            if (accessor["count"] == 0)
                file_.notes.add(place + ".count",
                                "is 0; primitives, instances and animation channels of it are "
                                "left out");
        });
    }

    void take_out_coordinates_without_accessor() {
        const std::size_t accessors = json_.contains("accessors") ? json_["accessors"].size() : 0;
        if (!json_.contains("meshes")) return;
        for (std::size_t m = 0; m < json_["meshes"].size(); ++m) {
            json& primitives = json_["meshes"][m]["primitives"];
            for (std::size_t p = 0; p < primitives.size(); ++p) {
                json& attributes = primitives[p]["attributes"];
                for (auto at = attributes.begin(); at != attributes.end();) {
                    if (at.key().starts_with("TEXCOORD_") &&
                        !(at->is_number_unsigned() && at->get<std::size_t>() < accessors)) {
                        file_.notes.add(
                            fmt::format("meshes[{}].primitives[{}].attributes.{}", m, p, at.key()),
                            "is no accessor; it is left out");
                        at = attributes.erase(at);
                    } else {
                        ++at;
                    }
                }
            }
        }
    }

    template <class Function>
    void for_each(const char* kind, const Function& function) const {
        if (!json_.contains(kind)) return;
        for (std::size_t i = 0; i < json_[kind].size(); ++i)
            function(json_[kind][i], fmt::format("{}[{}]", kind, i));
    }

    // Takes mesh and light from nodes that are not visible, and from all below them; cameras stay.
    void hide_nodes() {
        json hidden = json::array();
        for (std::size_t i = 0; i < parent_.size(); ++i) {
            const json* found = extension_of(json_["nodes"][i], visibility);
            if (found != nullptr && !found->value("visible", true)) hidden.push_back(i);
        }
        std::vector<bool> is_hidden = below(hidden);
        for (const json& node : hidden) is_hidden[node.get<std::size_t>()] = true;
        for (std::size_t i = 0; i < is_hidden.size(); ++i) {
            if (!is_hidden[i]) continue;
            json& node = json_["nodes"][i];
            node.erase("mesh");
            if (node.contains("extensions")) node["extensions"].erase("KHR_lights_punctual");
        }
    }

    void choose_variant(const std::string& name) {
        const std::size_t chosen = number_of_variant(name);
        if (!json_.contains("meshes")) return;
        for (json& mesh : json_["meshes"])
            for (json& primitive : mesh["primitives"]) {
                const json* found = extension_of(primitive, variants);
                if (found == nullptr) continue;
                for (const json& mapping : (*found)["mappings"])
                    if (std::ranges::count(mapping["variants"], json(chosen)) > 0) {
                        primitive["material"] = mapping["material"];
                        break;
                    }
            }
    }

    [[nodiscard]] std::size_t number_of_variant(const std::string& name) {
        json* found = extension_of(json_, variants);
        std::string names;
        if (found != nullptr)
            for (std::size_t i = 0; i < (*found)["variants"].size(); ++i) {
                const auto& other = (*found)["variants"][i]["name"].get_ref<const std::string&>();
                if (other == name) return i;
                names += fmt::format("{}'{}'", names.empty() ? "" : ", ", other);
            }
        throw InputError("{}: --variant {}: no such variant (there are: {})", file_.path, name,
                         names.empty() ? "none" : names);
    }

    // Its specular colour is the reflectance at normal incidence, of what is no metal: with an
    // index of refraction of 0 glTF's own words say so. What glossiness textures hold is up to
    // load_textures().
    static void convert_glossiness(json& material) {
        json* found = extension_of(material, glossiness);
        if (found == nullptr || extension_of(material, "KHR_materials_unlit") != nullptr) return;
        const json in = *found;
        const bool has_texture = in.contains("specularGlossinessTexture");
        json pbr = {{"baseColorFactor", in.value("diffuseFactor", json{1, 1, 1, 1})},
                    {"metallicFactor", 0},
                    {"roughnessFactor", has_texture ? 1 : 1 - in.value("glossinessFactor", 1.0)}};
        if (in.contains("diffuseTexture")) pbr["baseColorTexture"] = in["diffuseTexture"];
        json specular = {{"specularColorFactor", in.value("specularFactor", json{1, 1, 1})}};
        if (has_texture) specular["specularColorTexture"] = in["specularGlossinessTexture"];
        material["pbrMetallicRoughness"] = pbr;
        material["extensions"]["KHR_materials_specular"] = specular;
        material["extensions"]["KHR_materials_ior"] = {{"ior", 0}};
    }

    GltfFile& file_;
    json& json_;
    std::vector<std::size_t> parent_;  // of each node
};

}  // namespace

void mend_gltf(GltfFile& file, const std::string& variant) { Mender(file).mend(variant); }

}  // namespace manylight

// SPDX-License-Identifier: MIT
#include "scene/gltf/checking.hpp"

namespace manylight {
namespace {

constexpr const char* variants = "KHR_materials_variants";

class MeshChecker {
  public:
    explicit MeshChecker(Checking& in) : in_(in) {}

    void check() {
        variant_names();
        in_.each("meshes", [&](const JsonValue& object, std::size_t) { mesh(object); });
    }

  private:
    void mesh(const JsonValue& mesh) {
        const JsonValue primitives = mesh["primitives"].array();
        if (primitives.size() == 0) primitives.refuse("a mesh has at least one primitive");
        if (mesh.has("weights")) mesh["weights"].numbers(mesh["weights"].array().size());
        for (std::size_t i = 0; i < primitives.size(); ++i) {
            const JsonValue primitive = primitives.at(i).object();
            const JsonValue attributes = primitive["attributes"].object();
            for (const std::string& name : attributes.keys())
                if (!name.starts_with("TEXCOORD_"))  // see mend_gltf()
                    (void)attributes[name.c_str()].index(in_.count("accessors"), "accessor");
            in_.optional_index(primitive, "indices", "accessors", "accessor");
            in_.optional_index(primitive, "material", "materials", "material");
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
                    (void)targets.at(t)[name.c_str()].index(in_.count("accessors"), "accessor");
        }
    }

    // KHR_materials_variants: the variants, and a primitive's materials for them.
    void variant_names() {
        if (!in_.root.has("extensions") || !in_.root["extensions"].object().has(variants)) return;
        const JsonValue names = in_.root["extensions"][variants].object()["variants"].array();
        for (std::size_t i = 0; i < names.size(); ++i) (void)names.at(i).object()["name"].string();
        variant_count_ = names.size();
    }

    void mappings(const JsonValue& in) {
        const JsonValue mappings = in["mappings"].array();
        for (std::size_t i = 0; i < mappings.size(); ++i) {
            const JsonValue mapping = mappings.at(i).object();
            (void)mapping["material"].index(in_.count("materials"), "material");
            const JsonValue chosen = mapping["variants"].array();
            for (std::size_t v = 0; v < chosen.size(); ++v)
                (void)chosen.at(v).index(variant_count_, "variant");
        }
    }

    // KHR_draco_mesh_compression: what decoding takes for granted, and what it may grow to.
    void draco(const JsonValue& primitive, const JsonValue& in) {
        if (primitive.has("mode") && primitive["mode"].integer() != 4)
            primitive["mode"].refuse("{} cannot be compressed; 4 can", primitive["mode"].shown());
        (void)in["bufferView"].index(in_.count("bufferViews"), "bufferView");
        const JsonValue ids = in["attributes"].object();
        for (const std::string& name : ids.keys())
            if (ids[name.c_str()].integer() > 0xffffffffu)
                ids[name.c_str()].refuse("{} is no attribute", ids[name.c_str()].shown());
        const JsonValue attributes = primitive["attributes"].object();
        const auto count_of = [&](const JsonValue& accessor) {
            return in_.root["accessors"].at(
                accessor.index(in_.count("accessors"), "accessor"))["count"];
        };
        const JsonValue corners = count_of(primitive["indices"]);
        if (corners.integer() % 3 != 0)
            corners.refuse("{} corners are no whole number of triangles", corners.shown());
        // At the least: a triangle's corners in three tables, a position's numbers in two.
        in_.decompress(12 * corners.integer() + 24 * count_of(attributes["POSITION"]).integer(),
                       in);
    }

    Checking& in_;
    std::size_t variant_count_ = 0;
};

}  // namespace

void check_meshes(Checking& in) { MeshChecker(in).check(); }

}  // namespace manylight

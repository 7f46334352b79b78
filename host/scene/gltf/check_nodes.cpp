// SPDX-License-Identifier: MIT
#include <cmath>

#include "scene/gltf/checking.hpp"

namespace manylight {
namespace {

constexpr const char* lights_extension = "KHR_lights_punctual";
constexpr const char* instancing = "EXT_mesh_gpu_instancing";
constexpr const char* visibility = "KHR_node_visibility";
constexpr const char* emitter_points_key = "emitter_points";
constexpr std::uint64_t most_emitter_points = 1u << 24;
constexpr std::size_t none = ~std::size_t{0};

class NodeChecker {
  public:
    explicit NodeChecker(Checking& in) : in_(in) {}

    void check() {
        in_.each("cameras", [&](const JsonValue& object, std::size_t) { camera(object); });
        lights();
        in_.each("skins", [&](const JsonValue& object, std::size_t) { skin(object); });
        in_.each("nodes", [&](const JsonValue& object, std::size_t) { node(object); });
        in_.each("animations", [&](const JsonValue& object, std::size_t) { animation(object); });
        hierarchy();
        in_.each("scenes", [&](const JsonValue& object, std::size_t) { scene(object); });
        if (in_.root.has("scene")) (void)in_.root["scene"].index(in_.count("scenes"), "scene");
    }

  private:
    // KHR_lights_punctual
    void lights() {
        if (!in_.root.has("extensions") || !in_.root["extensions"].object().has(lights_extension))
            return;
        const JsonValue lights =
            in_.root["extensions"][lights_extension].object()["lights"].array();
        for (std::size_t i = 0; i < lights.size(); ++i) light(lights.at(i).object());
        light_count_ = lights.size();
    }

    void camera(const JsonValue& camera) {
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

    void skin(const JsonValue& skin) {
        const JsonValue joints = skin["joints"].array();
        for (std::size_t i = 0; i < joints.size(); ++i)
            (void)joints.at(i).index(in_.count("nodes"), "node");
        in_.optional_index(skin, "inverseBindMatrices", "accessors", "accessor");
        in_.optional_index(skin, "skeleton", "nodes", "node");
    }

    void animation(const JsonValue& animation) {
        const JsonValue samplers = animation["samplers"].array();
        for (std::size_t i = 0; i < samplers.size(); ++i) {
            for (const char* key : {"input", "output"})
                (void)samplers.at(i).object()[key].index(in_.count("accessors"), "accessor");
            if (samplers.at(i).has("interpolation"))
                (void)samplers.at(i)["interpolation"].one_of({"LINEAR", "STEP", "CUBICSPLINE"});
        }
        const JsonValue channels = animation["channels"].array();
        for (std::size_t i = 0; i < channels.size(); ++i) {
            (void)channels.at(i).object()["sampler"].index(samplers.size(), "sampler");
            in_.optional_index(channels.at(i)["target"].object(), "node", "nodes", "node");
        }
    }

    void node(const JsonValue& node) {
        in_.optional_index(node, "mesh", "meshes", "mesh");
        in_.optional_index(node, "camera", "cameras", "camera");
        in_.optional_index(node, "skin", "skins", "skin");
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
            (void)attributes[name.c_str()].index(in_.count("accessors"), "accessor");
    }

    // Every node has at most one parent, and none is its own ancestor.
    void hierarchy() {
        std::vector<std::size_t> parent(in_.count("nodes"), none);
        for (std::size_t i = 0; i < parent.size(); ++i) {
            const JsonValue node = in_.root["nodes"].at(i);
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
                if (path.size() > parent.size())
                    in_.root["nodes"].at(i).refuse("is its own ancestor");
                path.push_back(node);
            }
            for (const std::size_t n : path) rooted[n] = true;
        }
    }

    void scene(const JsonValue& scene) {
        extras(scene);
        if (!scene.has("nodes")) return;
        const JsonValue nodes = scene["nodes"].array();
        for (std::size_t i = 0; i < nodes.size(); ++i)
            (void)nodes.at(i).index(in_.count("nodes"), "node");
    }

    void extras(const JsonValue& scene) {
        if (!scene.has("extras")) return;
        const JsonValue extras = scene["extras"];
        if (!extras.keys().empty() && extras.has(emitter_points_key) &&
            extras[emitter_points_key].integer() > most_emitter_points)
            extras[emitter_points_key].refuse(
                "{} is more than {}", extras[emitter_points_key].shown(), most_emitter_points);
    }

    Checking& in_;
    std::size_t light_count_ = 0;
};

}  // namespace

void check_nodes(Checking& in) { NodeChecker(in).check(); }

}  // namespace manylight

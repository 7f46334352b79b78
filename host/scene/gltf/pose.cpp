// SPDX-License-Identifier: MIT
#include "scene/gltf/pose.hpp"

#include <algorithm>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/type_ptr.hpp>

#include "error.hpp"

namespace manylight {
namespace {

// A moment between two keyframes.
struct Moment {
    std::size_t before, after;  // keyframes
    double share;               // of the second one
    double length;              // from one to the other, s
};

Moment find_moment(const std::vector<glm::vec4>& times, double seconds) {
    const auto later =
        std::ranges::find_if(times, [&](const glm::vec4& t) { return t.x > seconds; });
    const auto after = static_cast<std::size_t>(later - times.begin());
    if (after == 0) return {0, 0, 0, 0};
    if (after == times.size()) return {after - 1, after - 1, 0, 0};
    const double length = double{times[after].x} - times[after - 1].x;
    return {after - 1, after, (seconds - times[after - 1].x) / length, length};
}

// A sampler's values at a moment, `width` of them per keyframe (glTF 2.0, appendix C).
std::vector<glm::dvec4> interpolate(const tinygltf::AnimationSampler& sampler, const Moment& m,
                                    const std::vector<glm::vec4>& values, std::size_t width,
                                    bool rotates) {
    const bool cubic = sampler.interpolation == "CUBICSPLINE";
    const double t = sampler.interpolation == "STEP" ? 0 : m.share;
    std::vector<glm::dvec4> out;
    for (std::size_t i = 0; i < width; ++i) {
        // A keyframe of a cubic spline: tangents to it, values, tangents from it.
        const auto at = [&](std::size_t key, std::size_t part) {
            return glm::dvec4(values[((cubic ? 3 : 1) * key + part) * width + i]);
        };
        const glm::dvec4 a = at(m.before, cubic ? 1 : 0);
        const glm::dvec4 b = at(m.after, cubic ? 1 : 0);
        if (t == 0) {
            out.push_back(a);
        } else if (cubic) {
            const double t2 = t * t;
            const double t3 = t2 * t;
            out.push_back((2 * t3 - 3 * t2 + 1) * a +
                          m.length * (t3 - 2 * t2 + t) * at(m.before, 2) + (3 * t2 - 2 * t3) * b +
                          m.length * (t3 - t2) * at(m.after, 0));
        } else if (rotates) {
            const glm::dquat q =
                glm::slerp(glm::dquat(a.w, a.x, a.y, a.z), glm::dquat(b.w, b.x, b.y, b.z), t);
            out.emplace_back(q.x, q.y, q.z, q.w);
        } else {
            out.push_back(a + t * (b - a));
        }
    }
    return out;
}

glm::dquat rotation_of(const glm::dvec4& v) {
    return glm::normalize(glm::dquat(v.w, v.x, v.y, v.z));
}

enum class Shape { one, many, rotation };  // of what a keyframe holds

// What a sampler of the first animation gives at a moment.
std::vector<glm::dvec4> sample(const GltfFile& file, const tinygltf::Model& model,
                               Accessors& accessors, int index, Attribute kind, Shape shape,
                               double seconds) {
    const tinygltf::AnimationSampler& sampler = model.animations.front().samplers[index];
    const std::string where = fmt::format("animations[0].samplers[{}]", index);
    const std::vector<glm::vec4> times =
        accessors.vectors(sampler.input, Attribute::scalar, where + ".input");
    for (std::size_t i = 1; i < times.size(); ++i)
        if (!(times[i].x > times[i - 1].x))
            throw InputError("{}: {}.input: keyframe {} at {} s is not after {} s", file.path,
                             where, i, times[i].x, times[i - 1].x);
    const std::vector<glm::vec4> values =
        accessors.vectors(sampler.output, kind, where + ".output");
    const std::size_t keys = times.size() * (sampler.interpolation == "CUBICSPLINE" ? 3 : 1);
    const std::size_t width = shape == Shape::many ? values.size() / keys : 1;
    if (values.size() != keys * width || width == 0)
        throw InputError("{}: {}.output: {} values for {} keyframes", file.path, where,
                         values.size(), times.size());
    return interpolate(sampler, find_moment(times, seconds), values, width,
                       shape == Shape::rotation);
}

// Whether a sampler of the first animation has no keyframes, or nothing at them: it moves nothing.
bool is_empty(const tinygltf::Model& model, int index) {
    const tinygltf::AnimationSampler& sampler = model.animations.front().samplers[index];
    return model.accessors[sampler.input].count == 0 || model.accessors[sampler.output].count == 0;
}

constexpr const char* pointer_extension = "KHR_animation_pointer";

// Whether what is there shows in an image, and is checked when it has changed.
bool can_point_to(const std::string& pointer) {
    constexpr const char* animated[] = {"/nodes/", "/meshes/", "/materials/", "/cameras/",
                                        "/extensions/KHR_lights_punctual/"};
    return std::ranges::any_of(animated, [&](const char* at) { return pointer.starts_with(at); });
}

// What a sampler gives at a moment, as the value that a pointer names.
nlohmann::json pointed_value(const GltfFile& file, const tinygltf::Model& model,
                             Accessors& accessors, const std::string& pointer, int sampler,
                             double seconds) {
    const std::string name = nlohmann::json::json_pointer(pointer).back();
    const bool rotates = pointer.starts_with("/nodes/") && name == "rotation";
    const Shape shape = name == "weights" ? Shape::many : rotates ? Shape::rotation : Shape::one;
    const std::vector<glm::dvec4> now =
        sample(file, model, accessors, sampler, Attribute::value, shape, seconds);
    const int output = model.animations.front().samplers[sampler].output;
    const int components = tinygltf::GetNumComponentsInType(model.accessors[output].type);
    if (name == "visible") return now[0].x != 0;
    if (components == 1 && shape == Shape::one) return now[0].x;
    nlohmann::json value = nlohmann::json::array();
    for (glm::dvec4 v : now) {
        if (rotates) v = glm::normalize(v);
        for (int c = 0; c < components; ++c) value.push_back(v[c]);
    }
    return value;
}

}  // namespace

void point_animation(GltfFile& file, double seconds) {
    using nlohmann::json;
    if (!file.json.contains("animations") || file.json["animations"].empty()) return;
    std::vector<std::pair<std::string, int>> targets;  // pointers and samplers
    std::size_t number = 0;
    for (const json& channel : file.json["animations"][0]["channels"]) {
        try {
            const json& target = channel.at("target");
            if (target.value("path", "") == "pointer" && target.contains("extensions") &&
                target["extensions"].contains(pointer_extension)) {
                const std::string pointer =
                    target["extensions"][pointer_extension].value("pointer", "");
                if (can_point_to(pointer))
                    targets.emplace_back(pointer, channel.at("sampler").get<int>());
            }
        } catch (const json::exception&) {
            throw InputError("{}: animations[0].channels[{}]: {} is of another form than glTF's",
                             file.path, number, channel.dump().substr(0, 200));
        }
        ++number;
    }
    if (targets.empty()) return;
    const tinygltf::Model model = parse_gltf(file);
    Accessors accessors(file, model);
    for (const auto& [pointer, sampler] : targets) {
        if (is_empty(model, sampler)) continue;
        try {
            if (!file.json.contains(json::json_pointer(pointer).parent_pointer()))
                throw InputError("{}: animations[0]: nothing has what '{}' names", file.path,
                                 pointer);
            file.json[json::json_pointer(pointer)] =
                pointed_value(file, model, accessors, pointer, sampler, seconds);
        } catch (const json::exception&) {
            throw InputError("{}: animations[0]: '{}' is no pointer into the file", file.path,
                             pointer);
        }
    }
}

glm::dmat4 Pose::Transform::whole() const {
    return glm::scale(glm::translate(matrix, translation) * glm::mat4_cast(rotation), scale);
}

Pose::Pose(const GltfFile& file, const tinygltf::Model& model, Accessors& accessors,
           std::optional<double> seconds, const glm::dvec3& origin)
    : file_(file), model_(model), is_at_rest_(!seconds) {
    std::vector<Transform> transforms(model.nodes.size());
    for (std::size_t i = 0; i < model.nodes.size(); ++i) {
        const tinygltf::Node& node = model.nodes[i];
        Transform& t = transforms[i];
        if (node.matrix.size() == 16) t.matrix = glm::make_mat4(node.matrix.data());
        if (node.translation.size() == 3) t.translation = glm::make_vec3(node.translation.data());
        if (node.rotation.size() == 4)
            t.rotation = rotation_of(glm::make_vec4(node.rotation.data()));
        if (node.scale.size() == 3) t.scale = glm::make_vec3(node.scale.data());
        const std::vector<double>& own = node.weights;
        std::vector<double> of_mesh;
        if (node.mesh >= 0) of_mesh = model.meshes[node.mesh].weights;
        const std::vector<double>& weights = own.empty() ? of_mesh : own;
        weights_.emplace_back(weights.begin(), weights.end());
    }
    if (seconds) {
        if (model.animations.empty())
            throw InputError("{}: --at {}: the file has no animations", file.path, *seconds);
        animate(accessors, *seconds, transforms);
    }
    place_nodes(transforms, origin);
}

void Pose::animate(Accessors& accessors, double seconds, std::vector<Transform>& transforms) {
    for (const tinygltf::AnimationChannel& channel : model_.animations.front().channels) {
        const int node = channel.target_node;
        const std::string& path = channel.target_path;
        if (node < 0 || path == "pointer" || is_empty(model_, channel.sampler)) continue;
        const Attribute kind = path == "weights"    ? Attribute::scalar
                               : path == "rotation" ? Attribute::rotation
                                                    : Attribute::position;
        const Shape shape = path == "weights"    ? Shape::many
                            : path == "rotation" ? Shape::rotation
                                                 : Shape::one;
        const std::vector<glm::dvec4> now =
            sample(file_, model_, accessors, channel.sampler, kind, shape, seconds);
        Transform& t = transforms[node];
        if (path == "translation") t.translation = now[0];
        if (path == "rotation") t.rotation = rotation_of(now[0]);
        if (path == "scale") t.scale = now[0];
        if (path == "weights") {
            weights_[node].clear();
            for (const glm::dvec4& v : now) weights_[node].push_back(static_cast<float>(v.x));
        }
    }
}

void Pose::place_nodes(const std::vector<Transform>& transforms, const glm::dvec3& origin) {
    to_world_.assign(model_.nodes.size(), glm::dmat4(1));
    std::vector<bool> is_child(model_.nodes.size(), false);
    for (const tinygltf::Node& node : model_.nodes)
        for (const int child : node.children) is_child[child] = true;
    std::vector<std::pair<int, glm::dmat4>> open;
    for (std::size_t i = 0; i < model_.nodes.size(); ++i)
        if (!is_child[i])
            open.emplace_back(static_cast<int>(i), glm::translate(glm::dmat4(1), -origin));
    while (!open.empty()) {
        const auto [node, parent] = open.back();
        open.pop_back();
        to_world_[node] = parent * transforms[node].whole();
        for (const int child : model_.nodes[node].children)
            open.emplace_back(child, to_world_[node]);
    }
}

std::vector<glm::dmat4> Pose::joint_matrices(int index, Accessors& accessors) const {
    const tinygltf::Skin& skin = model_.skins[index];
    std::vector<glm::mat4> bound(skin.joints.size(), glm::mat4(1));
    if (skin.inverseBindMatrices >= 0) {
        const std::string where = fmt::format("skins[{}].inverseBindMatrices", index);
        bound = accessors.matrices(skin.inverseBindMatrices, where);
        if (bound.size() < skin.joints.size())
            throw InputError("{}: {}: {} matrices for {} joints", file_.path, where, bound.size(),
                             skin.joints.size());
    }
    std::vector<glm::dmat4> out;
    for (std::size_t i = 0; i < skin.joints.size(); ++i)
        out.push_back(to_world_[skin.joints[i]] * glm::dmat4(bound[i]));
    return out;
}

namespace {

constexpr const char* instancing = "EXT_mesh_gpu_instancing";

// The attributes of a node's instances; null where it has none.
const nlohmann::json* instance_attributes(const GltfFile& file, int node) {
    const nlohmann::json& json = file.json["nodes"][node];
    if (!json.contains("extensions") || !json["extensions"].contains(instancing)) return nullptr;
    return &json["extensions"][instancing]["attributes"];
}

}  // namespace

std::size_t count_instances(const GltfFile& file, int node) {
    const nlohmann::json* attributes = instance_attributes(file, node);
    if (attributes == nullptr) return 1;
    for (const char* key : {"TRANSLATION", "ROTATION", "SCALE"})
        if (attributes->contains(key))
            return file.json["accessors"][(*attributes)[key].get<std::size_t>()]["count"];
    return 1;
}

std::vector<glm::dmat4> mesh_instances(const GltfFile& file, int node, Accessors& accessors) {
    const nlohmann::json* found = instance_attributes(file, node);
    if (found == nullptr) return {glm::dmat4(1)};
    const nlohmann::json& attributes = *found;
    std::vector<glm::dmat4> out;
    const auto read = [&](const char* key, Attribute kind) {
        std::vector<glm::vec4> values;
        if (!attributes.contains(key)) return values;
        const std::string where = fmt::format("nodes[{}].extensions.{}.{}", node, instancing, key);
        values = accessors.vectors(attributes[key], kind, where);
        if (values.size() != count_instances(file, node))
            throw InputError("{}: {}: {} values for {} instances", file.path, where, values.size(),
                             count_instances(file, node));
        out.resize(values.size(), glm::dmat4(1));
        return values;
    };
    if (!attributes.contains("TRANSLATION") && !attributes.contains("ROTATION") &&
        !attributes.contains("SCALE"))
        return {glm::dmat4(1)};  // as many as its own attributes say, all here
    const std::vector<glm::vec4> translations = read("TRANSLATION", Attribute::position);
    const std::vector<glm::vec4> rotations = read("ROTATION", Attribute::rotation);
    const std::vector<glm::vec4> scales = read("SCALE", Attribute::position);
    for (std::size_t i = 0; i < out.size(); ++i) {
        if (!translations.empty()) out[i] = glm::translate(out[i], glm::dvec3(translations[i]));
        if (!rotations.empty()) out[i] *= glm::mat4_cast(rotation_of(rotations[i]));
        if (!scales.empty()) out[i] = glm::scale(out[i], glm::dvec3(scales[i]));
    }
    return out;
}

}  // namespace manylight

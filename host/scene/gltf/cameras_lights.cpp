// SPDX-License-Identifier: MIT
#include "scene/gltf/cameras_lights.hpp"

#include <algorithm>
#include <cmath>

#include "scene/gltf/model.hpp"

namespace manylight {
namespace {

// The direction of a node's axis in the world, unit; 0 where its scale leaves none.
glm::dvec3 direction(const glm::dmat4& to_world, const glm::dvec3& axis) {
    const glm::dvec3 d = glm::dmat3(to_world) * axis;
    const double length = glm::length(d);
    return length > 1e-30 ? d / length : glm::dvec3(0);
}

// By a scale of 0 on all axes: glTF's way to hide what is at a node.
bool is_hidden(const glm::dmat4& to_world) { return glm::dmat3(to_world) == glm::dmat3(0); }

}  // namespace

void add_camera(Loading& in, int index) {
    const tinygltf::Node& node = in.model.nodes[index];
    const glm::dmat4& to_world = in.pose.to_world(index);
    const tinygltf::Camera& camera = in.model.cameras[node.camera];
    View view;
    view.name = !node.name.empty() ? node.name : camera.name;
    if (view.name.empty()) view.name = std::to_string(in.scene.views.size());
    view.camera_name = camera.name;
    // Only place and direction count: scale, shear and mirroring are left out.
    const glm::dvec3 back = direction(to_world, {0, 0, 1});
    const glm::dvec3 right = glm::cross(direction(to_world, {0, 1, 0}), back);
    if (!(glm::length(right) > 1e-6))
        return in.notes.add(fmt::format("nodes[{}]", index),
                            "is scaled to 0, which leaves no direction; its camera is left out");
    view.to_world[0] = glm::dvec4(glm::normalize(right), 0);
    view.to_world[1] = glm::dvec4(glm::cross(back, glm::normalize(right)), 0);
    view.to_world[2] = glm::dvec4(back, 0);
    view.to_world[3] = to_world[3];
    view.orthographic = camera.type == "orthographic";
    if (view.orthographic) {
        const double x = camera.orthographic.xmag;
        const double y = camera.orthographic.ymag;
        view.near = camera.orthographic.znear;
        view.far = camera.orthographic.zfar;
        view.aspect = std::abs(x / y);
        view.half_height = std::abs(y);
        if (x < 0) view.to_world[0] = -view.to_world[0];
        if (y < 0) view.to_world[1] = -view.to_world[1];
        if (x < 0 || y < 0)
            in.notes.add(fmt::format("cameras[{}]", node.camera),
                         "has a negative xmag or ymag; its image is mirrored");
    } else {
        view.near = camera.perspective.znear;
        view.far = camera.perspective.zfar;
        view.aspect = std::max(camera.perspective.aspectRatio, 0.0);
        view.half_height = std::tan(camera.perspective.yfov / 2);
    }
    in.scene.views.push_back(view);
}

void add_light(Loading& in, int node) {
    const tinygltf::Value& extended =
        extension(in.model.nodes[node].extensions, "KHR_lights_punctual");
    if (!extended.IsObject()) return;
    const int index = extended.Get("light").GetNumberAsInt();
    const tinygltf::Light& punctual = in.model.lights[index];
    const glm::dmat4& to_world = in.pose.to_world(node);
    glm::vec3 color(1);
    if (punctual.color.size() == 3)
        color = glm::vec3(punctual.color[0], punctual.color[1], punctual.color[2]);
    color *= static_cast<float>(punctual.intensity * in.options.lamp_scale);
    if (color == glm::vec3(0)) return;
    in.check_brightness(color,
                        fmt::format("KHR_lights_punctual.lights[{}]: color x intensity{}", index,
                                    in.options.lamp_scale == 1 ? "" : " x --lamp-scale"));
    const bool is_point = punctual.type == "point";
    const glm::dvec3 shines = is_point ? glm::dvec3(0) : direction(to_world, {0, 0, -1});
    if (is_hidden(to_world) || (!is_point && shines == glm::dvec3(0)))
        return in.notes.add(fmt::format("nodes[{}]", node), "is scaled to 0; its light is hidden");
    const auto position = glm::vec3(glm::dvec3(to_world[3]));
    Light light{float4(position, LIGHT_POINT), float4(glm::vec3(shines), punctual.range), float4(0),
                float4(color, 0)};
    if (punctual.type == "spot") {
        light.position.w = LIGHT_SPOT;
        light.edge =
            float4(spot_cone(punctual.spot.innerConeAngle, punctual.spot.outerConeAngle), 0, 0);
    } else if (punctual.type == "directional") {
        light.position.w = LIGHT_DIRECTIONAL;
        light.axis.w = 0;
    }
    in.scene.lights.push_back(light);
    const std::string& name = in.model.nodes[node].name;
    in.scene.light_names.push_back(name.empty() ? punctual.name : name);
}

}  // namespace manylight

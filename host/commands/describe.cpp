// SPDX-License-Identifier: MIT
#include "commands/describe.hpp"

#include <fmt/format.h>

namespace manylight {
namespace {

LightKind kind_of(const Light& light) { return static_cast<LightKind>(light.position.w); }

std::string kind_name(const Light& light) {
#define KIND_NAME(name, NAME, value) #name,
    static const char* names[] = {LIGHT_KINDS(KIND_NAME)};
#undef KIND_NAME
    return names[kind_of(light)];
}

// In the file's frame; of a directional light, the unit direction to it.
glm::dvec3 centre_of(const Scene& scene, const Light& light) {
    const glm::vec3 sides = glm::vec3(light.axis) + glm::vec3(light.edge);
    glm::vec3 centre(light.position);
    if (kind_of(light) == LIGHT_DIRECTIONAL) return -glm::vec3(light.axis);
    if (kind_of(light) == LIGHT_TRIANGLE) centre += sides / 3.f;
    if (kind_of(light) == LIGHT_QUAD) centre += sides / 2.f;
    return scene.in_file(centre);
}

std::string own_name(const Scene& scene, std::size_t light) {
    return light < scene.light_names.size() ? scene.light_names[light] : "";
}

}  // namespace

std::string name_of(const Scene& scene, std::size_t light) {
    const std::string name = own_name(scene, light);
    const std::string kind = kind_name(scene.lights[light]);
    return name.empty() ? fmt::format("{} light {}", kind, light)
                        : fmt::format("{} light '{}'", kind, name);
}

std::string place_of(const Scene& scene, std::size_t light) {
    const std::string place = show(centre_of(scene, scene.lights[light]));
    return kind_of(scene.lights[light]) == LIGHT_DIRECTIONAL ? "from " + place : "at " + place;
}

nlohmann::json describe(const Scene& scene, std::size_t light) {
    const Light& l = scene.lights[light];
    const char* place = kind_of(l) == LIGHT_DIRECTIONAL ? "direction" : "position";
    return {{"light", light},
            {"name", own_name(scene, light)},
            {"kind", kind_name(l)},
            {place, vector_json(centre_of(scene, l))}};
}

std::string show(const glm::dvec3& v) {
    return fmt::format("({:.2f}, {:.2f}, {:.2f})", v.x, v.y, v.z);
}

nlohmann::json vector_json(const glm::dvec3& v) { return {v.x, v.y, v.z}; }

}  // namespace manylight

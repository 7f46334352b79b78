// SPDX-License-Identifier: MIT
#include "commands/describe.hpp"

#include <fmt/format.h>

#include "lights/lights.hpp"

namespace manylight {
namespace {

// In the file's frame; of a light that is infinitely far, the unit direction to it.
glm::dvec3 centre_of(const Scene& scene, const Light& light) {
    const glm::vec3 centre = extent_of<float>(light).centre;
    return light_has(light, TRAIT_INFINITE) ? glm::dvec3(centre) : scene.in_file(centre);
}

std::string own_name(const Scene& scene, std::size_t light) {
    return light < scene.light_names.size() ? scene.light_names[light] : "";
}

}  // namespace

std::string name_of(const Scene& scene, std::size_t light) {
    const std::string name = own_name(scene, light);
    const char* kind = name_of(kind_of(scene.lights[light]));
    return name.empty() ? fmt::format("{} light {}", kind, light)
                        : fmt::format("{} light '{}'", kind, name);
}

std::string place_of(const Scene& scene, std::size_t light) {
    const std::string place = show(centre_of(scene, scene.lights[light]));
    return light_has(scene.lights[light], TRAIT_INFINITE) ? "from " + place : "at " + place;
}

nlohmann::json describe(const Scene& scene, std::size_t light) {
    const Light& l = scene.lights[light];
    const char* place = light_has(l, TRAIT_INFINITE) ? "direction" : "position";
    return {{"light", light},
            {"name", own_name(scene, light)},
            {"kind", name_of(kind_of(l))},
            {place, vector_json(centre_of(scene, l))}};
}

std::string show(const glm::dvec3& v) {
    return fmt::format("({:.2f}, {:.2f}, {:.2f})", v.x, v.y, v.z);
}

nlohmann::json vector_json(const glm::dvec3& v) { return {v.x, v.y, v.z}; }

}  // namespace manylight

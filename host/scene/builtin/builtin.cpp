// SPDX-License-Identifier: MIT
#include "scene/builtin/builtin.hpp"

#include <algorithm>
#include <cmath>

#include "error.hpp"
#include "scene/builtin/random.hpp"

namespace manylight {
namespace {

// What the sweeps are for is in docs/atlas.md.
const Builtin builtins[] = {
    {"cornell", "the paper's Cornell box: an area light as 64 oriented points", make_cornell},
    {.name = "dragon",
     .summary = "the paper's room about a detailed mesh: four coloured emitters as 100 points",
     .make = make_dragon,
     .takes_mesh = true},
    {"rooms", "400 rooms with doors, 10,000 lights, nearly all hidden", make_rooms},
    {"city",
     "streets by night: 100,000 lamps and windows",
     make_city,
     {{"lights", "number of lamps", true, 1e5, {1, 10, 100, 1e3, 1e4, 1e5, 1e6}}}},
    {"forest", "600 lamps in a wood of 15 million triangles, which are two meshes in 1500 places",
     make_forest},
    {"glossy",
     "1000 coloured lights over a shiny floor",
     make_glossy,
     {{"roughness", "of the floor", false, 0.25, {1, 0.5, 0.25, 0.1, 0.03, 0.01}}}},
    {"blinds",
     "192 lights behind slats and foliage, the sun among them",
     make_blinds,
     {{"slats", "slats in the window", true, 64, {4, 16, 64, 256, 512}}}},
    {"pinhole",
     "a bright lamp that lights a dim room through a hole",
     make_pinhole,
     {{"hole", "side of the hole, m", false, 0.04, {0.2, 0.06, 0.02, 0.006, 0.002}},
      {"lamp",
       "the lamp's intensity, cd; the room's are 0.05 to 0.3",
       false,
       3000,
       {2, 20, 200, 2000, 2e4, 2e5}}}},
    {"plates", "four lamps, small to large, mirrored by four metal plates, smooth to rough",
     make_plates},
    {"boards",
     "64 lights before and behind boards that face the camera, as does the wall behind them",
     make_boards,
     {{"boards", "boards across the image", true, 32, {2, 8, 32, 128, 512}}}},
    {"hidden",
     "10,000 lights about a ceiling, of which a share is below it",
     make_hidden,
     {{"visible",
       "share of the lights below the ceiling",
       false,
       0.01,
       {1, 0.1, 0.01, 1e-3, 1e-4}}}},
    {"near",
     "400 lights close to a wall",
     make_near,
     {{"distance",
       "of lights to the wall, over its width",
       false,
       0.01,
       {1, 0.1, 0.01, 1e-3, 1e-4}}}},
    {"range",
     "1000 lights between columns, from faint to bright",
     make_range,
     {{"ratio",
       "of the brightest intensity to the faintest",
       false,
       1e4,
       {1, 100, 1e4, 1e6, 1e8}}}},
    {"stacks",
     "4096 points and spots, of which many are at one place",
     make_stacks,
     {{"stack", "lights at one place", true, 64, {1, 8, 64, 512, 4096}}}},
    {"street", "10,000 lamps of a twentieth of a pixel each, which the camera sees", make_street},
    {"tubes",
     "16 emitters over a polished floor",
     make_tubes,
     {{"aspect", "length of an emitter over its width", false, 100, {1, 10, 100, 1e3, 1e4}}}},
    {"thicket",
     "120 lights about and among leaves",
     make_thicket,
     {{"leaves", "triangles, of one area together", true, 3000, {30, 300, 3000, 3e4, 3e5}}}},
    {"vault",
     "three dim lamps in a closed room, and 3000 bright ones about it",
     make_vault,
     {{"outside",
       "intensity of a lamp outside over that of one inside, at most",
       false,
       1e4,
       {1, 100, 1e4, 1e6, 1e8}}}},
};

const Builtin& find_builtin(const std::string& name) {
    std::string names;
    for (const Builtin& scene : builtins) {
        if (scene.name == name) return scene;
        names += fmt::format("{}{}", names.empty() ? "" : ", ", scene.name);
    }
    throw InputError("scene {}: no such scene (there are: {})", name, names);
}

void check(const SceneParameter& parameter, double value, std::string_view scene) {
    const bool in = value >= parameter.least() && value <= parameter.most();
    if (!in || (parameter.whole && value != std::floor(value)))
        throw InputError("--{} {}: scene {} takes {} from {} to {}", parameter.name, value, scene,
                         parameter.whole ? "whole numbers" : "numbers", parameter.least(),
                         parameter.most());
}

// With a value for every parameter of the scene.
BuiltinOptions complete(const Builtin& scene, BuiltinOptions options) {
    for (const auto& [name, value] : options.values) {
        const auto parameter = std::ranges::find(scene.parameters, name, &SceneParameter::name);
        if (parameter == scene.parameters.end())
            throw InputError("--{} {}: scene {} takes no such number", name, value, scene.name);
        check(*parameter, value, scene.name);
    }
    for (const SceneParameter& parameter : scene.parameters)
        options.values.try_emplace(std::string(parameter.name), parameter.usual);
    return options;
}

}  // namespace

std::span<const Builtin> all_builtins() { return builtins; }

float BuiltinOptions::number(std::string_view name) const {
    return static_cast<float>(values.find(name)->second);
}

unsigned BuiltinOptions::count(std::string_view name) const {
    return static_cast<unsigned>(values.find(name)->second);
}

GltfWriter make_builtin(const std::string& name, const BuiltinOptions& options) {
    const Builtin& scene = find_builtin(name);
    if (!options.mesh.empty() && !scene.takes_mesh)
        throw InputError("--mesh {}: scene {} takes no mesh", options.mesh, name);
    GltfWriter out;
    scene.make(out, complete(scene, options));
    return out;
}

glm::vec3 hue_color(float turns, float saturation) {
    glm::vec3 color;
    for (int c = 0; c < 3; ++c) {
        const float distance =
            std::abs(std::remainder(turns * 6 - 2 * static_cast<float>(c), 6.0f));
        color[c] = 1 - saturation * (1 - std::clamp(2 - distance, 0.0f, 1.0f));
    }
    return color;
}

}  // namespace manylight

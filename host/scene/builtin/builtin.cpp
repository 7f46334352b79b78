// SPDX-License-Identifier: MIT
#include "scene/builtin/builtin.hpp"

#include <algorithm>
#include <cmath>

#include "error.hpp"
#include "scene/builtin/random.hpp"

namespace manylight {
namespace {

constexpr Builtin builtins[] = {
    {"cornell", "the paper's Cornell box: an area light as 64 oriented points", make_cornell},
    {"dragon", "the paper's room about a detailed mesh: four coloured emitters as 100 points",
     make_dragon, false, true},
    {"rooms", "400 rooms with doors, 10,000 lights, nearly all hidden", make_rooms},
    {"city", "streets by night: 100,000 lamps and windows, or --lights of them", make_city, true},
    {"glossy", "1000 coloured lights over a shiny floor", make_glossy},
    {"blinds", "192 lights behind slats and foliage, the sun among them", make_blinds},
    {"pinhole", "a bright lamp that lights a dim room through a hole of 4 cm", make_pinhole},
    {"plates", "four lamps, small to large, mirrored by four metal plates, smooth to rough",
     make_plates},
};

}  // namespace

std::span<const Builtin> all_builtins() { return builtins; }

GltfWriter make_builtin(const std::string& name, const BuiltinOptions& options) {
    std::string names;
    for (const Builtin& scene : builtins) {
        names += fmt::format("{}{}", names.empty() ? "" : ", ", scene.name);
        if (scene.name != name) continue;
        if (options.lights > 0 && !scene.takes_lights)
            throw InputError("--lights {}: scene {} has its own number of lights", options.lights,
                             name);
        if (!options.mesh.empty() && !scene.takes_mesh)
            throw InputError("--mesh {}: scene {} takes no mesh", options.mesh, name);
        GltfWriter out;
        scene.make(out, options);
        return out;
    }
    throw InputError("scene {}: no such scene (there are: {})", name, names);
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

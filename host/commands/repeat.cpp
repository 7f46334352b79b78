// SPDX-License-Identifier: MIT
#include "commands/repeat.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace manylight {

std::string quote(const std::string& word) {
    const bool plain = !word.empty() && std::ranges::all_of(word, [](unsigned char c) {
        return std::isalnum(c) != 0 || std::string_view("_./,:=+-").find(c) != std::string::npos;
    });
    if (plain) return word;
    std::string out = "'";
    for (const char c : word) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return out + "'";
}

std::string field_of(std::string option) {
    std::ranges::replace(option, '-', '_');
    return option;
}

OptionList view_options(const SceneArguments& scene) {
    const char* storage = scene.storage == MeshStorage::shared   ? "shared"
                          : scene.storage == MeshStorage::copied ? "copied"
                                                                 : "auto";
    const char* headlight = scene.headlight == Headlight::always  ? "always"
                            : scene.headlight == Headlight::never ? "never"
                                                                  : "auto";
    OptionList list = {{"file", scene.file},
                       {"shift", fmt::format("{},{}", scene.shift.first, scene.shift.second)},
                       {"lamp-scale", scene.lamp_scale},
                       {"headlight", headlight},
                       {"cull-back-faces", scene.cull_back_faces},
                       {"instances", storage}};
    if (!scene.camera.empty()) list.emplace_back("camera", scene.camera);
    if (scene.emitter_points) list.emplace_back("emitter-points", *scene.emitter_points);
    if (scene.seconds) list.emplace_back("at", *scene.seconds);
    if (!scene.variant.empty()) list.emplace_back("variant", scene.variant);
    return list;
}

std::string view_words(const SceneArguments& scene) {
    const OptionList usual = view_options({});
    std::string out = quote(scene.file);
    for (const auto& option : view_options(scene)) {
        if (option.first == "file" || std::ranges::count(usual, option) > 0) continue;
        out += " --" + option.first;
        if (!option.second.is_boolean()) out += " " + quote(text_of(option.second));
    }
    return out;
}

}  // namespace manylight

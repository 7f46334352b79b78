// SPDX-License-Identifier: MIT
#include <filesystem>
#include <nlohmann/json.hpp>

#include "commands/commands.hpp"
#include "output/write_file.hpp"
#include "print.hpp"

namespace manylight {

namespace {

using nlohmann::json;

json to_json(const Builtin& scene) {
    json out = {{"name", scene.name}, {"summary", scene.summary}, {"parameters", json::array()}};
    for (const SceneParameter& p : scene.parameters)
        out["parameters"].push_back({{"name", p.name},
                                     {"summary", p.summary},
                                     {"whole", p.whole},
                                     {"usual", p.usual},
                                     {"sweep", p.sweep}});
    return out;
}

}  // namespace

int run_scene(const BuiltinArguments& arguments) {
    if (arguments.list) {
        json scenes = json::array();
        for (const Builtin& scene : all_builtins()) scenes.push_back(to_json(scene));
        const std::string text = scenes.dump(1) + "\n";
        std::fwrite(text.data(), 1, text.size(), stdout);
        return 0;
    }
    const std::string ending = ".glb";
    check_output("--output", arguments.output, {&ending, 1});
    make_builtin(arguments.name, arguments.options).write(arguments.output);
    say("wrote {} ({} KiB)\n", arguments.output,
        std::filesystem::file_size(arguments.output) >> 10);
    return 0;
}

}  // namespace manylight

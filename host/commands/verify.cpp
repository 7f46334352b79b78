// SPDX-License-Identifier: MIT
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <span>
#include <sstream>

#include "commands/commands.hpp"
#include "commands/options/words.hpp"
#include "commands/verify_report.hpp"
#include "error.hpp"
#include "output/progress.hpp"
#include "output/write_file.hpp"
#include "print.hpp"
#include "verify/stages.hpp"
#include "verify/verify_all.hpp"

namespace manylight {
namespace {

using nlohmann::json;

void print_device(const DeviceInfo& info) {
    say("{}: {}, {}, driver {}\n", info.name, info.platform, info.version, info.driver);
    if (const std::string hint = known_trouble(info); !hint.empty())
        say("known trouble: {}\n", hint);
}

Verification verify_file(const LoadedScene& loaded, Device device, const VerifyOptions& options) {
    Verification found{{}, Coverage(device.form().lanes > 1), false, options.only};
    SceneChecks scene{loaded.scene.file,
                      "",
                      loaded.scene.seen_triangle_count(),
                      loaded.scene.lights.size(),
                      loaded.width,
                      loaded.height,
                      {}};
    scene.checks = Verifier(device, loaded.scene, loaded.camera, options).all();
    found.coverage.add(device.take_launched(), scene.checks);
    found.scenes.push_back(std::move(scene));
    return found;
}

void write_json(const std::string& path, const json& out) {
    const std::string text = out.dump(2, ' ', true, json::error_handler_t::replace) + "\n";
    if (path == "-")
        std::fwrite(text.data(), 1, text.size(), stdout);  // plain ASCII, of many lines
    else
        write_file(path, std::as_bytes(std::span(text)));
}

void check_json(const VerifyArguments& arguments) {
    if (arguments.json.empty() || arguments.json == "-") return;
    check_output("--json", arguments.json);
    if (!arguments.scene.file.empty() && same_file(arguments.json, arguments.scene.file))
        throw InputError("--json {}: is the scene itself", arguments.json);
}

void check_scenes(const VerifyArguments& arguments) {
    const std::vector<std::string>& scenes = arguments.only.scenes;
    if (scenes.empty()) return;
    if (!arguments.scene.file.empty())
        throw InputError("--scene {}: goes without a file", scenes.front());
    for (const std::string& scene : scenes)
        options::require_word("--scene", scene, verified_scenes());
}

// What shows a file, or how it is read.
void refuse_without_file(const SceneArguments& scene) {
    if (!scene.camera.empty() || !scene.variant.empty() || scene.emitter_points || scene.seconds ||
        scene.lamp_scale != 1 || scene.cull_back_faces || scene.shift != std::pair(0.0, 0.0) ||
        scene.storage != MeshStorage::automatic || scene.headlight != Headlight::automatic)
        throw InputError(
            "verify: --camera, --variant, --emitter-points, --at, --lamp-scale, --headlight, "
            "--cull-back-faces, --shift and --instances go with a file");
}

}  // namespace

int run_verify(const VerifyArguments& given) {
    VerifyArguments arguments = given;
    SceneArguments& scene = arguments.scene;
    const bool built_in = scene.file.empty();
    check_json(arguments);
    if (built_in) refuse_without_file(scene);
    check_scenes(arguments);
    VerifyOptions options;
    options.seed = arguments.seed;
    options.clusters = arguments.clusters;
    options.only = arguments.only;
    std::optional<LoadedScene> loaded;
    if (!built_in) {
        if (scene.width == 0 && scene.height == 0) scene.width = 96;
        loaded = load(scene);
        if (!arguments.json.empty()) refuse_scene_file(loaded->scene, "--json", arguments.json);
        options.width = loaded->width;
        options.height = loaded->height;
    } else {
        // Of 4 to 3: tiles that are whole, and cut ones.
        options.width = scene.width ? scene.width : scene.height ? scene.height * 4 / 3 + 1 : 56;
        options.height = scene.height ? scene.height : std::max(options.width * 3 / 4, 1u);
        options.most_entries = 10'000;
    }
    Device device = Device::open(scene.device, scene.threads, scene.lanes);
    // As commands that repeat a check name all that.
    if (scene.device.empty()) scene.device = fmt::to_string(select_device(""));
    scene.lanes = device.form().lanes;
    scene.width = options.width;
    scene.height = options.height;
    const bool quiet = arguments.json == "-";
    if (!quiet) print_device(device.info());
    const Verification found = [&] {
        if (loaded) return verify_file(*loaded, device, options);
        Progress progress("verifying", quiet);
        return verify_all(device, options, [&](double share) { progress.set(share); });
    }();
    if (!quiet) {
        for (const SceneChecks& s : found.scenes)
            say("{}: {} triangles, {} lights, {} x {} pixels{}{}\n", s.name, s.triangles, s.lights,
                s.width, s.height, s.summary.empty() ? "" : ": ", s.summary);
        say("\n");
        print_table(found, arguments);
        say("\nlargest: the largest difference from the scalar reference, over its tolerance (eps: "
            "2^-23).\nborderline: items that rounding of their rays' ends decides either "
            "way.\n");
        std::istringstream verdict(found.verdict());
        for (std::string line; std::getline(verdict, line);) say("{}\n", line);
    }
    if (!arguments.json.empty()) write_json(arguments.json, to_json(found, arguments, device));
    return found.passed() ? 0 : 3;
}

}  // namespace manylight

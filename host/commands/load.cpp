// SPDX-License-Identifier: MIT
#include <cmath>

#include "commands/commands.hpp"
#include "error.hpp"
#include "output/progress.hpp"
#include "output/write_file.hpp"
#include "print.hpp"
#include "stages/device_scene.hpp"

namespace manylight {
namespace {

constexpr double default_aspect = 16.0 / 9;

void choose_size(LoadedScene& out, const SceneArguments& arguments, double aspect) {
    if (aspect == 0) aspect = default_aspect;
    double width = arguments.width;
    double height = arguments.height;
    if (width == 0 && height == 0) height = 512;
    if (width == 0) width = std::round(height * aspect);
    if (height == 0) height = std::round(width / aspect);
    if (width < 1 || width > 65536 || height < 1 || height > 65536)
        throw InputError("{}: the image would have {} x {} pixels; give --width and --height",
                         arguments.file, width, height);
    out.width = static_cast<unsigned>(width);
    out.height = static_cast<unsigned>(height);
}

}  // namespace

void refuse_scene_file(const Scene& scene, const std::string& option, const std::string& path) {
    for (const std::string& file : scene.files)
        if (same_file(path, file))
            throw InputError("{} {}: is a file of the scene; name another with {}", option, path,
                             option);
}

WideBvh build_bvh(const LoadedScene& loaded, const Device& device, bool quiet) {
    Progress progress("building", quiet);
    const unsigned lanes = device.form().bvh_width;
    return build_wide_bvh(loaded.scene, lanes, lanes, reach_of(loaded.scene, loaded.camera),
                          [&](double share) { progress.set(share); });
}

LoadedScene load(const SceneArguments& arguments, bool quiet) {
    LoadedScene out;
    Scene& scene = out.scene;
    {
        Progress progress("loading", quiet);
        scene = load_scene(arguments.file, {.seconds = arguments.seconds,
                                            .lamp_scale = arguments.lamp_scale,
                                            .cull_back_faces = arguments.cull_back_faces,
                                            .variant = arguments.variant,
                                            .storage = arguments.storage,
                                            .report = [&](double share) { progress.set(share); }});
    }
    for (const std::string& warning : scene.warnings) warn("{}", warning);
    out.emitter_points = arguments.emitter_points.value_or(scene.emitter_points.value_or(0));
    add_emitters(scene, out.emitter_points);
    const bool sized = arguments.width > 0 && arguments.height > 0;
    out.view =
        find_view(scene, arguments.camera,
                  sized ? static_cast<double>(arguments.width) / arguments.height : default_aspect);
    const bool dark = is_dark(scene);
    out.headlight =
        arguments.headlight == Headlight::always ||
        (arguments.headlight == Headlight::automatic && dark && scene.triangle_count() > 0);
    if (out.headlight) add_headlight(scene, out.view);
    if (dark && out.headlight)
        warn("{}: nothing in it gives light; the camera's headlight does (--headlight never: none)",
             scene.file);
    else if (scene.lights.empty())
        warn("{}: the scene has no lights", scene.file);
    choose_size(out, arguments, out.view.aspect);
    out.camera = make_camera(out.view, out.width, out.height, arguments.shift);
    return out;
}

}  // namespace manylight

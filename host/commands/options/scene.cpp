// SPDX-License-Identifier: MIT
#include "commands/options/scene.hpp"

#include <fmt/format.h>

#include "commands/options/values.hpp"
#include "pipeline/aov.hpp"
#include "samplers/table.hpp"

namespace manylight::options {

namespace {

const std::map<std::string, MeshStorage> mesh_storages = {{"auto", MeshStorage::automatic},
                                                          {"copied", MeshStorage::copied},
                                                          {"shared", MeshStorage::shared}};

const std::map<std::string, Headlight> headlights = {
    {"never", Headlight::never}, {"auto", Headlight::automatic}, {"always", Headlight::always}};

const std::map<std::string, unsigned> device_forms = {
    {"auto", 0}, {"gpu", 1}, {"4", 4}, {"8", 8}, {"16", 16}};

}  // namespace

void add_view(CLI::App& command, SceneArguments& scene, unsigned height) {
    command.add_option("--camera", scene.camera, "camera by name (default: the file's first)");
    command
        .add_option("--emitter-points", scene.emitter_points,
                    "replace emissive triangles by N oriented points of equal power; 0: area "
                    "lights (default: the file's wish, or 0)")
        ->check(whole(0, 1 << 24));
    command.add_option("--at", scene.seconds,
                       "SECONDS of the file's first animation (default: everything at rest)");
    command
        .add_option("--lamp-scale", scene.lamp_scale,
                    "multiply what point, spot and directional lights emit; 0.00146413 takes back "
                    "the 683 lm/W of Blender's export, which emissive surfaces do not get")
        ->check(number(1e-12, 1e12));
    add_choice(command, "--headlight", scene.headlight, headlights,
               "a light at the camera: never, always or auto (where nothing in the file gives "
               "light or shows without)");
    command.add_flag("--cull-back-faces", scene.cull_back_faces,
                     "no ray meets the back of what is not doubleSided, as in viewers of glTF "
                     "(default: all is seen from both sides, as in Blender)");
    command.add_option("--variant", scene.variant,
                       "materials of that variant of the file's (KHR_materials_variants)");
    add_choice(command, "--instances", scene.storage, mesh_storages,
               "meshes that stand in several places: shared (stored once), copied (faster to "
               "trace) or auto (shared where copies would take more than 256 MiB)");
    command.add_option("--device", scene.device,
                       "OpenCL device: number or part of its name, see 'manylight devices'");
    add_choice(command, "--device-form", scene.lanes, device_forms,
               "how kernels are laid out: auto (as suits the device), in vectors of 4, 8 or 16 "
               "lanes, or gpu (what GPUs run, on any device)");
    command.add_option("--threads", scene.threads, "processors that a CPU device may use")
        ->check(whole(1, 4096));
    command.add_option("--width", scene.width, "image width (default: from the height)")
        ->check(whole(1, 65536));
    command.add_option("--height", scene.height, fmt::format("image height (default: {})", height))
        ->check(whole(1, 65536));
    command.add_option_function<std::string>(
        "--shift", [&scene](const std::string& text) { scene.shift = parse_shift(text); },
        "X,Y: show what is so many pixels farther right and down, as a shifted lens does");
}

void add_scene(CLI::App& command, SceneArguments& scene, unsigned height) {
    command.add_option("file", scene.file, "glTF 2.0 scene, .gltf or .glb")->check(not_empty());
    add_view(command, scene, height);
}

void add_clusters(CLI::App& command, ClusterOptions& clusters) {
    const char* group = "Clusters (samplers by contribution)";
    command.add_option("--tile-size", clusters.tile_size, "pixels of a tile's side")
        ->check(power_of_two())
        ->capture_default_str()
        ->group(group);
    command.add_option("--max-depth", clusters.max_depth, "depth of a tile's quadtree")
        ->check(whole(0, 7))
        ->capture_default_str()
        ->group(group);
    command
        .add_option("--normal-threshold", clusters.normal_threshold,
                    "split where corner normals differ by more degrees")
        ->check(number(0, 180))
        ->capture_default_str()
        ->group(group);
    command
        .add_option("--visibility-threshold", clusters.shadow.threshold,
                    "split where less than this share of the lights is seen")
        ->check(number(0, 1))
        ->capture_default_str()
        ->group(group);
}

namespace {

std::string parameter_list() {
    std::string text;
    for (const Sampler& s : all_samplers())
        for (const Parameter& p : s.parameters)
            text += fmt::format("  {:<24}{}: {} ({} to {}; default: {})\n", p.name, s.name,
                                p.summary, p.least, p.most, p.value);
    return text.empty() ? text : "\nParameters of samplers, for --set:\n" + text;
}

}  // namespace

std::string sampler_list(bool automatic) {
    std::string text = "\nSamplers:\n";
    if (automatic)
        text +=
            fmt::format("  {:<24}{}\n", "auto",
                        "exhaustive where lights are no more than light samples, else adaptive");
    for (const Sampler& s : all_samplers())
        text +=
            fmt::format("  {:<24}{} ({})\n", s.name, s.summary, s.biased ? "biased" : "unbiased");
    text += parameter_list();
    return text;
}

std::string aov_list() {
    std::string text = "\nLayers for --aov:\n";
    for (const Aov& aov : all_aovs()) text += fmt::format("  {:<24}{}\n", aov.name, aov.summary);
    return text;
}

}  // namespace manylight::options

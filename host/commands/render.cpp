// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "commands/commands.hpp"
#include "error.hpp"
#include "output/cluster_map.hpp"

namespace manylight {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

std::string mebibytes(std::size_t bytes) {
    return fmt::format("{:.1f} MiB", static_cast<double>(bytes) / (1 << 20));
}

void print_plan(const LoadedScene& loaded, const Plan& plan, const DeviceInfo& device) {
    fmt::print("{}: {} triangles, {} lights, camera '{}'\n", loaded.scene.file,
               loaded.scene.triangle_count(), loaded.scene.lights.size(), loaded.view_name);
    fmt::print("{} ({})\n", device.name, device.platform);
    fmt::print("memory: scene {}, image {}, pixels in work {}", mebibytes(plan.scene_bytes),
               mebibytes(plan.image_bytes), mebibytes(plan.batch_bytes));
    if (plan.matrix_bytes > 0)
        fmt::print(", of which contribution matrix {}", mebibytes(plan.matrix_bytes));
    fmt::print("; {} batch{}\n", plan.batches, plan.batches == 1 ? "" : "es");
}

nlohmann::json make_stats(const RenderOptions& o, const LoadedScene& loaded, const Plan& plan,
                          const FrameResult& result, Device& device) {
    nlohmann::json stages = nlohmann::json::object();
    for (const auto& [stage, seconds] : device.stage_seconds()) stages[stage] = seconds;
    return {
        {"version", MANYLIGHT_VERSION},
        {"scene", loaded.scene.file},
        {"sampler", o.sampler},
        {"light_samples", o.light_samples},
        {"spp", o.spp},
        {"seed", o.seed},
        {"width", loaded.width},
        {"height", loaded.height},
        {"device", device.info().name},
        {"platform", device.info().platform},
        {"triangles", loaded.scene.triangle_count()},
        {"lights", loaded.scene.lights.size()},
        {"clusters", result.clusters},
        {"batches", plan.batches},
        {"rays", {{"primary", result.primary_rays}, {"shadow", result.shadow_rays}}},
        {"memory_bytes", {{"device_peak", device.peak_bytes()}, {"matrix", plan.matrix_bytes}}},
        {"seconds",
         {{"compile", device.compile_seconds()},
          {"prepare", result.prepare_seconds},
          {"render", result.render_seconds}}},
        {"stage_seconds", stages},
    };
}

Metadata make_metadata(const nlohmann::json& stats) {
    return {
        {"Software", fmt::format("manylight {}", stats["version"].get<std::string>())},
        {"manylight:version", stats["version"].get<std::string>()},
        {"manylight:scene", stats["scene"].get<std::string>()},
        {"manylight:sampler", stats["sampler"].get<std::string>()},
        {"manylight:light_samples", stats["light_samples"].get<int>()},
        {"manylight:spp", stats["spp"].get<int>()},
        {"manylight:seed", fmt::format("{}", stats["seed"].get<unsigned>())},
        {"manylight:device", stats["device"].get<std::string>()},
        {"manylight:seconds", stats["seconds"]["total"].get<float>()},
    };
}

void write_text(const std::string& path, const std::string& text) {
    const std::string aside = path + ".part";
    std::error_code error;
    if (!(std::ofstream(aside) << text).flush()) {
        std::filesystem::remove(aside, error);
        throw RuntimeError("{}: cannot be written", path);
    }
    std::filesystem::rename(aside, path, error);
    if (error) throw RuntimeError("{}: cannot be written: {}", path, error.message());
}

std::vector<std::string> outputs_of(const RenderArguments& arguments) {
    if (!arguments.outputs.empty()) return arguments.outputs;
    return {std::filesystem::path(arguments.scene.file).stem().string() + ".png"};
}

}  // namespace

int run_render(const RenderArguments& arguments) {
    const auto start = Clock::now();
    const std::vector<std::string> outputs = outputs_of(arguments);
    for (const std::string& path : outputs) check_output(path);
    if (!arguments.cluster_map.empty()) check_output(arguments.cluster_map);
    RenderOptions options = arguments.options;
    const bool in_exr = std::ranges::any_of(outputs, [](auto& o) { return o.ends_with(".exr"); });
    if (!options.aovs.empty() && !in_exr)
        throw InputError("--aov: layers go to an .exr file; give one with --output");
    if (!arguments.cluster_map.empty())
        for (const char* name : {"cluster", "representative"}) options.aovs.emplace_back(name);

    const LoadedScene loaded = load(arguments.scene);
    const double load_seconds = seconds_since(start);
    Device device = Device::open(arguments.scene.device, arguments.scene.threads);
    const auto build_start = Clock::now();
    const unsigned lanes = lanes_for(device.info());
    const WideBvh bvh =
        build_wide_bvh(loaded.scene, lanes, lanes, reach_of(loaded.scene, loaded.camera));
    const double build_seconds = seconds_since(build_start);
    options.width = loaded.width;
    options.height = loaded.height;
    Frame frame(device, loaded.scene, bvh, loaded.camera, options);
    if (!arguments.quiet) print_plan(loaded, frame.plan(), device.info());
    frame.prepare();
    FrameResult result = [&] {
        Progress progress("rendering", arguments.quiet);
        return frame.render(progress);
    }();

    nlohmann::json stats = make_stats(options, loaded, frame.plan(), result, device);
    stats["seconds"]["load"] = load_seconds;
    stats["seconds"]["build"] = build_seconds;
    stats["seconds"]["total"] = seconds_since(start);
    const Metadata metadata = make_metadata(stats);
    const float exposure =
        arguments.exposure ? std::exp2(*arguments.exposure) : auto_exposure(result.image);
    std::vector<Image> layers = {result.image};
    for (const auto& [name, image] : result.aovs)
        if (std::ranges::count(arguments.options.aovs, name)) layers.push_back(image);
    for (const std::string& path : outputs) {
        if (path.ends_with(".exr"))
            write_exr(path, layers, metadata);
        else
            write_png(path, result.image, exposure, metadata);
    }
    if (!arguments.cluster_map.empty())
        write_png(arguments.cluster_map, draw_cluster_map(result.image, exposure, result.aovs), 1,
                  metadata);
    if (!arguments.stats.empty()) write_text(arguments.stats, stats.dump(2) + "\n");
    if (!arguments.quiet) {
        fmt::print(
            "{}, {} light samples, {} spp, {} x {}: {:.2f} s (prepare {:.2f}, render {:.2f})\n",
            options.sampler, options.light_samples, options.spp, options.width, options.height,
            seconds_since(start), result.prepare_seconds, result.render_seconds);
        for (const std::string& path : outputs) fmt::print("wrote {}\n", path);
    }
    return 0;
}

}  // namespace manylight

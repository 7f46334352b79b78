// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "clock.hpp"
#include "commands/commands.hpp"
#include "error.hpp"
#include "output/cluster_map.hpp"
#include "output/write_file.hpp"
#include "pipeline/aov.hpp"
#include "pipeline/frame.hpp"
#include "print.hpp"

namespace manylight {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

std::string mebibytes(std::size_t bytes) {
    return fmt::format("{:.1f} MiB", static_cast<double>(bytes) / (1 << 20));
}

// The files to be made, with the options that name them.
std::vector<std::pair<std::string, std::string>> files_of(const RenderArguments& arguments,
                                                          const std::vector<std::string>& images) {
    std::vector<std::pair<std::string, std::string>> files;
    for (const std::string& image : images) files.emplace_back("--output", image);
    if (!arguments.cluster_map.empty()) files.emplace_back("--cluster-map", arguments.cluster_map);
    if (!arguments.stats.empty()) files.emplace_back("--stats", arguments.stats);
    if (!arguments.checkpoint.empty()) files.emplace_back("--checkpoint", arguments.checkpoint);
    return files;
}

// Before any work: every file can be written, and none is the scene or another one.
void check_files(const RenderArguments& arguments, const std::vector<std::string>& images) {
    const auto files = files_of(arguments, images);
    for (const auto& [option, path] : files) {
        std::vector<std::string> endings;
        if (option == "--output") endings = {".exr", ".png"};
        if (option == "--cluster-map") endings = {".png"};
        check_output(option, path, endings);
    }
    for (std::size_t i = 0; i < files.size(); ++i) {
        const auto& [option, path] = files[i];
        if (same_file(path, arguments.scene.file))
            throw InputError("{} {}: is the scene itself", option, path);
        for (std::size_t j = 0; j < i; ++j)
            if (same_file(path, files[j].second))
                throw InputError("{} {}: is written by {} too", option, path, files[j].first);
    }
}

// A checkpoint is hours of work: none is lost by forgetting an option.
void check_checkpoint(const RenderArguments& arguments) {
    if (arguments.checkpoint.empty()) return;
    if (arguments.seconds > 0)
        throw InputError("--checkpoint {}: not with --time, which ends where the machine is",
                         arguments.checkpoint);
    std::error_code error;
    if (!arguments.resume && fs::exists(arguments.checkpoint, error))
        throw InputError(
            "--checkpoint {}: is there already; add --resume to go on from it, or "
            "remove it",
            arguments.checkpoint);
}

// Renders on from the checkpoint, if asked for and there is one, and saves to it.
FrameResult render_frame(Frame& frame, const RenderArguments& arguments) {
    const std::string& file = arguments.checkpoint;
    Progress progress("rendering", arguments.quiet);
    if (file.empty()) return frame.render(progress);
    std::optional<FrameState> state;
    if (arguments.resume && fs::exists(file)) state = read_checkpoint(file, frame.name());
    const std::string name = frame.name();
    const Saving saving{arguments.checkpoint_seconds,
                        [&](const FrameState& now) { write_checkpoint(file, name, now); }};
    return frame.render(progress, saving, state ? &*state : nullptr);
}

void print_plan(const LoadedScene& loaded, const Plan& plan, const DeviceInfo& device) {
    say("{}: {} triangles, {} lights, camera '{}'\n", loaded.scene.file,
        loaded.scene.seen_triangle_count(), loaded.scene.lights.size(), loaded.view.name);
    say("{} ({})\n", device.name, device.platform);
    say("memory: {}: scene {}, image {}, pixels in work {}", mebibytes(plan.total_bytes()),
        mebibytes(plan.scene_bytes), mebibytes(plan.image_bytes), mebibytes(plan.batch_bytes));
    if (plan.clusters) say(", of which contribution matrix {}", mebibytes(plan.matrix_bytes));
    say("; {} batch{}\n", plan.batches, plan.batches == 1 ? "" : "es");
}

// All parameters that the image depends on.
json make_parameters(const RenderOptions& o, const LoadedScene& loaded, const FrameResult& result) {
    return {
        {"scene", loaded.scene.file},
        {"camera", loaded.view.name},
        {"emitter_points", loaded.emitter_points},
        {"sampler", o.sampler},
        {"light_samples", result.light_samples},
        {"later_light_samples", result.later_light_samples},
        {"spp", result.spp},
        {"seed", o.seed},
        {"pixel_centre", !o.jitters()},
        {"hide_emitters", o.hide_emitters},
        {"reflections", o.reflections},
        {"width", o.width},
        {"height", o.height},
        {"tile_size", o.clusters.tile_size},
        {"max_depth", o.clusters.max_depth},
        {"normal_threshold", o.clusters.normal_threshold},
        {"visibility_threshold", o.clusters.shadow.threshold},
    };
}

json make_stats(json parameters, const RenderOptions& o, const LoadedScene& loaded,
                const Plan& plan, const FrameResult& result, Device& device) {
    json stats = std::move(parameters);
    stats["version"] = MANYLIGHT_VERSION;
    stats["device"] = device.info().name;
    stats["platform"] = device.info().platform;
    stats["triangles"] = loaded.scene.seen_triangle_count();
    stats["lights"] = loaded.scene.lights.size();
    stats["clusters"] = result.clusters;
    stats["batches"] = plan.batches;
    stats["rays"] = {{"primary", result.primary_rays}, {"shadow", result.shadow_rays}};
    stats["memory_bytes"] = {{"device_peak", device.peak_bytes()},
                             {"planned", plan.total_bytes()},
                             {"matrix", plan.matrix_bytes}};
    stats["seconds"] = {{"compile", device.compile_seconds()},
                        {"prepare", result.prepare_seconds},
                        {"render", result.render_seconds}};
    if (o.estimates_error())
        stats["error"] = result.error ? json{{"relmse", result.error->relmse},
                                             {"standard_error", result.error->standard_error}}
                                      : json();
    const std::map<std::string, double> stages = device.stage_seconds();
    stats["stage_seconds"] = stages;
    const auto shadows = stages.find("shadows");
    if (shadows != stages.end() && shadows->second > 0 && !result.is_resumed)
        stats["shadow_mrays_per_s"] =
            static_cast<double>(result.shadow_rays) / shadows->second / 1e6;
    return stats;
}

Metadata make_metadata(const json& parameters, const json& stats) {
    Metadata metadata = {{"Software", "manylight " MANYLIGHT_VERSION},
                         {"manylight:version", MANYLIGHT_VERSION},
                         {"manylight:device", stats["device"].get<std::string>()},
                         {"manylight:seconds", stats["seconds"]["total"].get<float>()}};
    for (const auto& [key, value] : parameters.items()) {
        const std::string name = "manylight:" + key;
        if (value.is_string())
            metadata[name] = value.get<std::string>();
        else if (value.is_number_float())
            metadata[name] = value.get<float>();
        else  // integers as text: a seed may not fit a signed one
            metadata[name] = value.dump();
    }
    return metadata;
}

bool asks_clusters(const RenderOptions& options) {
    return std::ranges::any_of(all_aovs(), [&](const Aov& aov) {
        return aov.needs_clusters && std::ranges::count(options.aovs, aov.name) > 0;
    });
}

void warn_if_not_finite(const Image& image) {
    const auto bad = std::ranges::count_if(image.values, [](float v) { return !std::isfinite(v); });
    if (bad > 0) warn("{} pixel values are not finite numbers", bad);
}

void write_files(const RenderArguments& arguments, const std::vector<std::string>& images,
                 const FrameResult& result, const json& stats, const Metadata& metadata) {
    const float exposure =
        arguments.exposure ? std::exp2(*arguments.exposure) : auto_exposure(result.image);
    std::vector<Image> layers = {result.image};
    for (const auto& [name, image] : result.aovs)
        if (std::ranges::count(arguments.options.aovs, name)) layers.push_back(image);
    for (const std::string& path : images) {
        if (path.ends_with(".exr"))
            write_exr(path, layers, metadata);
        else
            write_png(path, result.image, exposure, metadata);
    }
    if (!arguments.cluster_map.empty())
        write_png(arguments.cluster_map, draw_cluster_map(result.image, exposure, result.aovs), 1,
                  metadata);
    if (!arguments.stats.empty()) {
        const std::string text = stats.dump(2, ' ', true, json::error_handler_t::replace) + "\n";
        write_file(arguments.stats, std::as_bytes(std::span(text)));
    }
}

// When rendering has to end for everything to be written in time.
Clock::time_point deadline_of(const RenderArguments& arguments,
                              const std::vector<std::string>& images, const LoadedScene& loaded) {
    // Seconds that encoding a pixel takes, of a layer where there are several.
    constexpr double exr = 450e-9;
    constexpr double png = 450e-9;
    const double pixels = static_cast<double>(loaded.width) * loaded.height;
    double writing = 0.03;
    for (const std::string& image : images)
        writing += pixels * (image.ends_with(".exr")
                                 ? exr * static_cast<double>(1 + arguments.options.aovs.size())
                                 : png);
    return process_start() + std::chrono::duration_cast<Clock::duration>(
                                 std::chrono::duration<double>(arguments.seconds - writing));
}

void print_summary(const RenderOptions& options, const FrameResult& result, double seconds) {
    const std::string later = result.later_light_samples == result.light_samples
                                  ? ""
                                  : fmt::format(", later {}", result.later_light_samples);
    say("{}, {} light samples{}, {:.4g} spp, {} x {}: {:.2f} s (prepare {:.2f}, render "
        "{:.2f})\n",
        options.sampler, result.light_samples, later, result.spp, options.width, options.height,
        seconds, result.prepare_seconds, result.render_seconds);
    if (result.error)
        say("estimated relMSE {:.3g} +- {:.2g} (95%){}\n", result.error->relmse,
            result.error->margin(),
            result.error->is_noise() ? ", or more: the image is mostly noise" : "");
    else if (options.estimates_error())
        say("no estimate of relMSE: the image is black, or no pixel has two samples\n");
}

// What was asked for, and is not so.
void warn_of_goals(const RenderArguments& arguments, const FrameResult& result,
                   const json& seconds) {
    const double target = arguments.options.target_error;
    if (target > 0 && !result.error)
        warn("--target-error {}: not reached, as far as is known: there is no estimate", target);
    else if (target > 0 && result.error->most() > target)
        warn("--target-error {}: not reached: relMSE may be {:.3g}", target, result.error->most());
    const double taken = seconds_since(process_start());
    const double over = taken - arguments.seconds;
    if (arguments.seconds == 0 || over < 0.05) return;
    std::string parts;
    double others = taken;
    for (const char* part : {"load", "build", "compile", "prepare", "render"}) {
        const double own = seconds[part].get<double>();
        parts += fmt::format("{} {:.2f}, ", part, own);
        others -= own;
    }
    warn(
        "--time {}: exceeded by {:.2f} s ({}start and write {:.2f}); every pixel gets one sample, "
        "whatever the time",
        arguments.seconds, over, parts, others);
}

}  // namespace

int run_render(const RenderArguments& arguments) {
    const auto start = Clock::now();
    std::vector<std::string> images = arguments.outputs;
    if (images.empty()) images = {fs::path(arguments.scene.file).stem().string() + ".png"};
    check_files(arguments, images);
    check_checkpoint(arguments);
    RenderOptions options = arguments.options;
    if (!options.aovs.empty() &&
        std::ranges::none_of(images, [](const std::string& i) { return i.ends_with(".exr"); }))
        throw InputError("--aov {}: layers go to an .exr file; name one with --output",
                         options.aovs[0]);
    if (!arguments.cluster_map.empty()) {
        if (arguments.sampler != "auto" && find_sampler(arguments.sampler).table != Table::clusters)
            throw InputError("--cluster-map {}: sampler {} makes no clusters",
                             arguments.cluster_map, arguments.sampler);
        for (const char* name : {"cluster", "representative"}) options.aovs.emplace_back(name);
    }

    const auto compilers = std::make_shared<Compilers>(arguments.scene.threads);
    const LoadedScene loaded = load(arguments.scene, arguments.quiet);
    for (const auto& [option, path] : files_of(arguments, images))
        refuse_scene_file(loaded.scene, option, path);
    const double load_seconds = seconds_since(start);
    options.sampler = arguments.sampler;
    if (arguments.sampler == "auto") {
        const SamplerChoice choice = choose_sampler(loaded.scene.lights.size(),
                                                    options.samples_of(0), asks_clusters(options));
        options.sampler = choice.name;
        if (!arguments.quiet) say("sampler {}: {}\n", choice.name, choice.reason);
    }
    options.width = loaded.width;
    options.height = loaded.height;
    Device device =
        Device::open(arguments.scene.device, arguments.scene.threads, arguments.scene.lanes);
    device.help(compilers);
    const auto build_start = Clock::now();
    const WideBvh bvh = build_bvh(loaded, device, arguments.quiet);
    const double build_seconds = seconds_since(build_start);
    if (arguments.seconds > 0) options.deadline = deadline_of(arguments, images, loaded);
    Frame frame(device, loaded.scene, bvh, loaded.camera, options);
    if (!arguments.quiet) print_plan(loaded, frame.plan(), device.info());
    frame.prepare();
    FrameResult result = render_frame(frame, arguments);
    warn_if_not_finite(result.image);

    const json parameters = make_parameters(options, loaded, result);
    json stats = make_stats(parameters, options, loaded, frame.plan(), result, device);
    stats["seconds"]["load"] = load_seconds;
    stats["seconds"]["build"] = build_seconds;
    stats["seconds"]["total"] = seconds_since(start);
    if (arguments.top_lights > 0)
        stats["top_lights"] =
            report_top_lights(loaded, arguments.top_lights, options.seed, arguments.quiet);
    write_files(arguments, images, result, stats, make_metadata(parameters, stats));
    if (!arguments.quiet) {
        print_summary(options, result, seconds_since(start));
        for (const auto& [option, path] : files_of(arguments, images))
            if (fs::exists(path)) say("wrote {}\n", path);
    }
    warn_of_goals(arguments, result, stats["seconds"]);
    return 0;
}

}  // namespace manylight

// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <utility>

#include "clock.hpp"
#include "commands/commands.hpp"
#include "commands/repeat.hpp"
#include "error.hpp"
#include "output/cluster_map.hpp"
#include "output/write_file.hpp"
#include "pipeline/aov.hpp"
#include "pipeline/frame.hpp"
#include "pipeline/top_lights.hpp"
#include "print.hpp"
#include "signals.hpp"

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

// What to go on from, if asked for and there.
std::optional<Checkpoint> find_checkpoint(const RenderArguments& arguments) {
    std::error_code error;
    if (!arguments.resume || !fs::exists(arguments.checkpoint, error)) return {};
    return read_checkpoint(arguments.checkpoint);
}

// Renders, on from the checkpoint if there is one, and saves to it.
FrameResult render_frame(Frame& frame, const RenderArguments& arguments,
                         const std::optional<Checkpoint>& checkpoint) {
    const std::string& file = arguments.checkpoint;
    Progress progress("rendering", arguments.quiet);
    if (file.empty()) return frame.render(progress);
    const std::string name = frame.name();
    const Saving saving{arguments.checkpoint_seconds,
                        [&](const FrameState& now) { write_checkpoint(file, name, now); }};
    return frame.render(progress, saving, checkpoint ? &checkpoint->state : nullptr);
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

// All options that the image depends on, and the pixel samples that it has: with as many, they
// repeat it.
OptionList options_of(const RenderArguments& arguments, const RenderOptions& options,
                      const LoadedScene& loaded, const Device& device, const FrameResult& result) {
    SceneArguments scene = arguments.scene;
    if (scene.camera.empty() && !loaded.scene.views.empty()) scene.camera = loaded.view.name;
    scene.emitter_points = loaded.emitter_points;
    scene.headlight = loaded.headlight ? Headlight::always : Headlight::never;
    OptionList list = view_options(scene);
    for (auto& option : image_options(options)) list.push_back(std::move(option));
    if (result.spp == std::floor(result.spp))
        list.emplace_back("spp", static_cast<uint>(result.spp));
    else
        list.emplace_back("spp", result.spp);
    if (options.memory > 0) list.emplace_back("memory", options.memory);
    list.emplace_back("device", device.info().name);
    const unsigned lanes = device.form().lanes;
    list.emplace_back("device-form", lanes == 1 ? "gpu" : std::to_string(lanes));
    return list;
}

json make_stats(const OptionList& options, bool estimates_error, const LoadedScene& loaded,
                const Plan& plan, const FrameResult& result, Device& device) {
    json stats = {{"version", MANYLIGHT_VERSION},
                  {"platform", device.info().platform},
                  {"first_light_samples", result.light_samples},
                  {"later_light_samples", result.later_light_samples}};
    for (const auto& [option, value] : options) stats[field_of(option)] = value;
    stats["triangles"] = loaded.scene.seen_triangle_count();
    stats["lights"] = loaded.scene.lights.size();
    stats["clusters"] = result.clusters;
    stats["batches"] = plan.batches;
    stats["cut_short"] = result.is_cut_short;
    stats["rays"] = {{"primary", result.primary_rays}, {"shadow", result.shadow_rays}};
    stats["memory_bytes"] = {{"device_peak", device.peak_bytes()},
                             {"planned", plan.total_bytes()},
                             {"matrix", plan.matrix_bytes}};
    if (estimates_error)
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

Metadata make_metadata(const OptionList& options, const FrameResult& result, double seconds,
                       const Device& device) {
    Metadata metadata = {
        {"Software", "manylight " MANYLIGHT_VERSION},
        {"manylight:version", MANYLIGHT_VERSION},
        {"manylight:platform", device.info().platform},
        {"manylight:first_light_samples", std::to_string(result.light_samples)},
        {"manylight:later_light_samples", std::to_string(result.later_light_samples)},
        {"manylight:cut_short", result.is_cut_short ? "true" : "false"},
        {"manylight:seconds", static_cast<float>(seconds)}};
    // As text: a seed may not fit a signed integer, nor a number a float.
    for (const auto& [option, value] : options)
        metadata["manylight:" + field_of(option)] = text_of(value);
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

void write_images(const RenderArguments& arguments, const std::vector<std::string>& images,
                  const FrameResult& result, const Metadata& metadata) {
    // By as many stops as the header says, so that these make the same picture.
    const float stops = arguments.exposure.value_or(std::log2(auto_exposure(result.image)));
    const float exposure = std::exp2(stops);
    Metadata exposed = metadata;
    exposed["manylight:exposure"] = fmt::format("{}", stops);
    std::vector<Image> layers = {result.image};
    for (const auto& [name, image] : result.aovs)
        if (std::ranges::count(arguments.options.aovs, name)) layers.push_back(image);
    for (const std::string& path : images) {
        if (path.ends_with(".exr"))
            write_exr(path, layers, metadata);
        else
            write_png(path, result.image, exposure, exposed);
    }
    if (!arguments.cluster_map.empty())
        write_png(arguments.cluster_map, draw_cluster_map(result.image, exposure, result.aovs), 1,
                  exposed);
}

void write_stats(const std::string& path, const json& stats) {
    if (path.empty()) return;
    const std::string text = stats.dump(2, ' ', true, json::error_handler_t::replace) + "\n";
    write_file(path, std::as_bytes(std::span(text)));
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

// The parts of a run, in their order, with their seconds: together all of it.
using Phases = std::vector<std::pair<const char*, double>>;

// "load 0.10, render 2.30".
std::string describe(const Phases& phases) {
    std::string out;
    for (const auto& [name, seconds] : phases)
        out += fmt::format("{}{} {:.2f}", out.empty() ? "" : ", ", name, seconds);
    return out;
}

void print_summary(const RenderOptions& options, const FrameResult& result, const Phases& phases) {
    const std::string later = result.later_light_samples == result.light_samples
                                  ? ""
                                  : fmt::format(", later {}", result.later_light_samples);
    double seconds = 0;
    for (const auto& [name, part] : phases) seconds += part;
    say("{}, {} light samples{}, {:.4g} spp, {} x {}: {:.2f} s ({})\n", options.sampler,
        result.light_samples, later, result.spp, options.width, options.height, seconds,
        describe(phases));
    if (result.error)
        say("estimated relMSE {:.3g} +- {:.2g} (95%){}\n", result.error->relmse,
            result.error->margin(),
            result.error->is_noise() ? ", or more: the image is mostly noise" : "");
    else if (options.estimates_error())
        say("no estimate of relMSE: the image is black, or no pixel has two samples\n");
}

// What was asked for, and is not so.
void warn_of_goals(const RenderArguments& arguments, const FrameResult& result,
                   const Phases& phases) {
    const double target = arguments.options.target_error;
    if (target > 0 && !result.error)
        warn("--target-error {}: not reached, as far as is known: there is no estimate", target);
    else if (target > 0 && result.error->most() > target)
        warn("--target-error {}: not reached: relMSE may be {:.3g}", target, result.error->most());
    const double over = seconds_since(process_start()) - arguments.seconds;
    if (arguments.seconds == 0 || over < 0.05) return;
    warn("--time {}: exceeded by {:.2f} s ({}); every pixel gets one sample, whatever the time",
         arguments.seconds, over, describe(phases));
}

bool is_black(const Image& image) {
    return std::ranges::all_of(image.values, [](float v) { return v == 0; });
}

void warn_of_interrupt(const RenderOptions& options, const FrameResult& result) {
    if (result.spp == 0)
        return warn("interrupted before any pixel sample was done: nothing is written");
    const bool open_ended = options.deadline || options.target_error > 0;
    const double empty =
        static_cast<double>(result.empty_pixels) / static_cast<double>(result.image.pixel_count());
    warn("interrupted at {:.4g}{} spp{}", result.spp,
         open_ended ? "" : fmt::format(" of {}", options.spp),
         empty > 0
             ? fmt::format("; {:.3g}% of the pixels have no sample and are black", 100 * empty)
             : "");
}

}  // namespace

int run_render(const RenderArguments& arguments) {
    const auto start = Clock::now();
    Phases phases = {
        {"start", std::max(std::chrono::duration<double>(start - process_start()).count(), 0.0)}};
    auto phase_ends = [&phases, begun = start](const char* name) mutable {
        phases.emplace_back(name, seconds_since(begun));
        begun = Clock::now();
    };
    std::vector<std::string> images = arguments.outputs;
    if (images.empty()) images = {fs::path(arguments.scene.file).stem().string() + ".png"};
    check_files(arguments, images);
    check_checkpoint(arguments);
    RenderOptions options = arguments.options;
    if (!options.aovs.empty() && !arguments.repeats_aovs &&
        std::ranges::none_of(images, [](const std::string& i) { return i.ends_with(".exr"); }))
        throw InputError("--aov {}: layers go to an .exr file; name one with --output",
                         options.aovs[0]);
    if (!arguments.cluster_map.empty()) {
        if (arguments.sampler != "auto" && !find_sampler(arguments.sampler).clusters)
            throw InputError("--cluster-map {}: sampler {} makes no clusters",
                             arguments.cluster_map, arguments.sampler);
        for (const char* name : {"cluster", "representative"}) options.aovs.emplace_back(name);
    }
    const std::optional<Checkpoint> checkpoint = find_checkpoint(arguments);
    if (checkpoint) options.begun_spp = checkpoint->state.get<uint>("spp");

    const auto compilers = std::make_shared<Compilers>(arguments.scene.threads);
    const LoadedScene loaded = load(arguments.scene, arguments.quiet);
    for (const auto& [option, path] : files_of(arguments, images))
        refuse_scene_file(loaded.scene, option, path);
    options.sampler = arguments.sampler;
    if (arguments.sampler == "auto") {
        const SamplerChoice choice = choose_sampler(loaded.scene.lights.size(),
                                                    options.samples_of(0), asks_clusters(options));
        options.sampler = choice.name;
        if (!arguments.quiet) say("sampler {}: {}\n", choice.name, choice.reason);
    }
    options.width = loaded.width;
    options.height = loaded.height;
    phase_ends("load");
    Device device =
        Device::open(arguments.scene.device, arguments.scene.threads, arguments.scene.lanes);
    device.help(compilers);
    phase_ends("device");
    const WideBvh bvh = build_bvh(loaded, device, arguments.quiet);
    phase_ends("build");
    if (arguments.seconds > 0) options.deadline = deadline_of(arguments, images, loaded);
    options.interrupted = [said = false]() mutable {
        if (pending_signal() != 0 && !std::exchange(said, true))
            warn("interrupted: the image so far will be written; once more ends at once");
        return pending_signal() != 0;
    };
    Frame frame(device, loaded.scene, bvh, loaded.camera, options);
    if (checkpoint && checkpoint->render != frame.name())
        throw InputError(
            "--resume: {}: is of another render: the scene, the options or the device differ",
            arguments.checkpoint);
    if (!arguments.quiet) print_plan(loaded, frame.plan(), device.info());
    frame.prepare();
    const KeptSignals kept;
    const FrameResult result = render_frame(frame, arguments, checkpoint);
    phase_ends("upload");
    const double inside = device.compile_seconds() + result.prepare_seconds + result.render_seconds;
    phases.back().second = std::max(phases.back().second - inside, 0.0);
    phases.insert(phases.end(), {{"compile", device.compile_seconds()},
                                 {"prepare", result.prepare_seconds},
                                 {"render", result.render_seconds}});
    warn_if_not_finite(result.image);
    if (result.is_cut_short && pending_signal() != 0) {
        warn_of_interrupt(options, result);
        if (result.spp == 0) end_by(pending_signal());
    } else if (is_black(result.image)) {
        warn("the image is black: {}", why_black(loaded.scene, loaded.camera, loaded.width,
                                                 loaded.height, options.hide_emitters));
        phase_ends("look why");
    }

    const OptionList list = options_of(arguments, options, loaded, device, result);
    json stats = make_stats(list, options.estimates_error(), loaded, frame.plan(), result, device);
    if (arguments.top_lights > 0 && pending_signal() == 0) {
        stats["top_lights"] =
            report_top_lights(loaded, arguments.top_lights, options.seed, arguments.quiet);
        phase_ends("top lights");
    }
    write_images(arguments, images, result,
                 make_metadata(list, result, seconds_since(process_start()), device));
    phase_ends("write");
    double total = 0;
    for (const auto& [name, seconds] : phases) {
        stats["seconds"][name] = seconds;
        total += seconds;
    }
    stats["seconds"]["total"] = total;
    write_stats(arguments.stats, stats);
    if (!arguments.quiet) {
        print_summary(options, result, phases);
        for (const auto& [option, path] : files_of(arguments, images))
            if (fs::exists(path)) say("wrote {}\n", path);
    }
    warn_of_goals(arguments, result, phases);
    if (pending_signal() != 0) end_by(pending_signal());
    return 0;
}

}  // namespace manylight

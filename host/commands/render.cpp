// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <utility>

#include "clock.hpp"
#include "commands/commands.hpp"
#include "commands/render_facts.hpp"
#include "commands/render_files.hpp"
#include "error.hpp"
#include "explain/top_lights.hpp"
#include "pipeline/aov.hpp"
#include "pipeline/frame.hpp"
#include "print.hpp"
#include "signals.hpp"

namespace manylight {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

std::string mebibytes(std::size_t bytes) {
    return fmt::format("{:.1f} MiB", static_cast<double>(bytes) / (1 << 20));
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

bool asks_clusters(const RenderOptions& options) {
    return std::ranges::any_of(all_aovs(), [&](const Aov& aov) {
        return aov.needs_clusters && std::ranges::count(options.aovs, aov.name) > 0;
    });
}

void warn_if_not_finite(const Image& image) {
    const auto bad = std::ranges::count_if(image.values, [](float v) { return !std::isfinite(v); });
    if (bad > 0) warn("{} pixel values are not finite numbers", bad);
}

// The parts of a run, in their order, with their seconds: together all of it.
struct Timer {
    Clock::time_point begun = Clock::now();  // the part that is not yet there
    std::vector<std::pair<std::string, double>> phases = {
        {"start", std::max(std::chrono::duration<double>(begun - process_start()).count(), 0.0)}};

    void ends(const char* name) {
        phases.emplace_back(name, seconds_since(begun));
        begun = Clock::now();
    }
    // Takes what is known of parts of the last one out of it.
    void part(const std::vector<std::pair<std::string, double>>& parts) {
        for (const auto& [name, seconds] : parts) phases.back().second -= seconds;
        phases.back().second = std::max(phases.back().second, 0.0);
        phases.insert(phases.end(), parts.begin(), parts.end());
    }
    [[nodiscard]] double total() const {
        double sum = 0;
        for (const auto& [name, seconds] : phases) sum += seconds;
        return sum;
    }
    // "load 0.10, render 2.30".
    [[nodiscard]] std::string text() const {
        std::string out;
        for (const auto& [name, seconds] : phases)
            out += fmt::format("{}{} {:.2f}", out.empty() ? "" : ", ", name, seconds);
        return out;
    }
};

void print_summary(const RenderOptions& options, const FrameResult& result, const Timer& timer) {
    const std::string later = result.later_light_samples == result.light_samples
                                  ? ""
                                  : fmt::format(", later {}", result.later_light_samples);
    say("{}, {} light samples{}, {:.4g} spp, {} x {}: {:.2f} s ({})\n", options.sampler,
        result.light_samples, later, result.spp, options.width, options.height, timer.total(),
        timer.text());
    if (result.error)
        say("estimated relMSE {:.3g} +- {:.2g} (95%){}\n", result.error->relmse,
            result.error->margin(),
            result.error->is_noise() ? ", or more: the image is mostly noise" : "");
    else if (options.estimates_error())
        say("no estimate of relMSE: the image is black, or no pixel has two samples\n");
}

// What was asked for, and is not so.
void warn_of_goals(const RenderArguments& arguments, const FrameResult& result,
                   const Timer& timer) {
    const double target = arguments.options.target_error;
    if (target > 0 && !result.error)
        warn("--target-error {}: not reached, as far as is known: there is no estimate", target);
    else if (target > 0 && result.error->most() > target)
        warn("--target-error {}: not reached: relMSE may be {:.3g}", target, result.error->most());
    const double over = seconds_since(process_start()) - arguments.seconds;
    if (arguments.seconds == 0 || over < 0.05) return;
    warn("--time {}: exceeded by {:.2f} s ({}); every pixel gets one sample, whatever the time",
         arguments.seconds, over, timer.text());
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

// Refuses what cannot be made; returns what is asked of the frame.
RenderOptions check(const RenderArguments& arguments, const std::vector<std::string>& images) {
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
    return options;
}

std::string sampler_of(const RenderArguments& arguments, const RenderOptions& options,
                       const LoadedScene& loaded) {
    if (arguments.sampler != "auto") return arguments.sampler;
    const SamplerChoice choice =
        choose_sampler(loaded.scene.lights.size(), options.samples_of(0), asks_clusters(options));
    if (!arguments.quiet) say("sampler {}: {}\n", choice.name, choice.reason);
    return std::string(choice.name);
}

// Whether a signal has come, which is said once.
std::function<bool()> interrupted_by_signal() {
    return [said = false]() mutable {
        if (pending_signal() != 0 && !std::exchange(said, true))
            warn("interrupted: the image so far will be written; once more ends at once");
        return pending_signal() != 0;
    };
}

// What is odd about the image.
void warn_of_image(const RenderOptions& options, const LoadedScene& loaded,
                   const FrameResult& result, Timer& timer) {
    warn_if_not_finite(result.image);
    if (result.is_cut_short && pending_signal() != 0) {
        warn_of_interrupt(options, result);
        if (result.spp == 0) end_by(pending_signal());
    } else if (is_black(result.image)) {
        warn("the image is black: {}", why_black(loaded.scene, loaded.camera, loaded.width,
                                                 loaded.height, options.hide_emitters));
        timer.ends("look why");
    }
}

// Writes and prints all that was asked for.
void report(const RenderArguments& arguments, const std::vector<std::string>& images,
            const RenderOptions& options, const LoadedScene& loaded, const Plan& plan,
            const FrameResult& result, Device& device, Timer& timer) {
    const OptionList list = options_of(arguments, options, loaded, device, result);
    json stats = make_stats(list, options.estimates_error(), loaded, plan, result, device);
    if (arguments.top_lights > 0 && pending_signal() == 0) {
        stats["top_lights"] =
            report_top_lights(loaded, arguments.top_lights, options.seed, arguments.quiet);
        timer.ends("top lights");
    }
    write_images(arguments, images, result,
                 make_metadata(list, result, seconds_since(process_start()), device));
    timer.ends("write");
    for (const auto& [name, seconds] : timer.phases) stats["seconds"][name] = seconds;
    stats["seconds"]["total"] = timer.total();
    write_stats(arguments.stats, stats);
    if (!arguments.quiet) {
        print_summary(options, result, timer);
        for (const auto& [option, path] : files_of(arguments, images))
            if (fs::exists(path)) say("wrote {}\n", path);
    }
    warn_of_goals(arguments, result, timer);
}

}  // namespace

int run_render(const RenderArguments& arguments) {
    Timer timer;
    std::vector<std::string> images = arguments.outputs;
    if (images.empty()) images = {fs::path(arguments.scene.file).stem().string() + ".png"};
    RenderOptions options = check(arguments, images);
    const std::optional<Checkpoint> checkpoint = find_checkpoint(arguments);
    if (checkpoint) options.begun_spp = checkpoint->state.get<uint>("spp");

    const auto compilers = std::make_shared<Compilers>(arguments.scene.threads);
    const LoadedScene loaded = load(arguments.scene, arguments.quiet);
    for (const auto& [option, path] : files_of(arguments, images))
        refuse_scene_file(loaded.scene, option, path);
    options.sampler = sampler_of(arguments, options, loaded);
    options.width = loaded.width;
    options.height = loaded.height;
    timer.ends("load");
    Device device =
        Device::open(arguments.scene.device, arguments.scene.threads, arguments.scene.lanes);
    device.help(compilers);
    timer.ends("device");
    const WideBvh bvh = build_bvh(loaded, device, arguments.quiet);
    timer.ends("build");
    if (arguments.seconds > 0) options.deadline = deadline_of(arguments, images, loaded);
    options.interrupted = interrupted_by_signal();
    Frame frame(device, loaded.scene, bvh, loaded.camera, options);
    if (checkpoint && checkpoint->render != frame.name())
        throw InputError(
            "--resume: {}: is of another render: the scene, the options or the device differ",
            arguments.checkpoint);
    if (!arguments.quiet) print_plan(loaded, frame.plan(), device.info());
    frame.prepare();
    const KeptSignals kept;
    const FrameResult result = render_frame(frame, arguments, checkpoint);
    timer.ends("upload");
    timer.part({{"compile", device.compile_seconds()},
                {"prepare", result.prepare_seconds},
                {"render", result.render_seconds}});
    warn_of_image(options, loaded, result, timer);
    report(arguments, images, options, loaded, frame.plan(), result, device, timer);
    if (pending_signal() != 0) end_by(pending_signal());
    return 0;
}

}  // namespace manylight

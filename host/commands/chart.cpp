// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "chart/folder.hpp"
#include "chart/report.hpp"
#include "clock.hpp"
#include "commands/commands.hpp"
#include "commands/repeat.hpp"
#include "error.hpp"
#include "output/error_picture.hpp"
#include "output/write_file.hpp"
#include "print.hpp"

namespace manylight {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

constexpr unsigned default_height = 256;

std::string join(const std::vector<uint>& values) {
    return fmt::format("{}", fmt::join(values, ","));
}

// The scene with the options that say how it is seen, as for manylight render.
std::string view_options(const ChartArguments& arguments, const LoadedScene& loaded) {
    const SceneArguments& scene = arguments.scene;
    std::string out = view_words(scene);
    if (!scene.device.empty()) out += " --device " + quote(scene.device);
    if (scene.threads > 0) out += fmt::format(" --threads {}", scene.threads);
    out += fmt::format(" --width {} --height {}", loaded.width, loaded.height);
    if (arguments.memory > 0) out += fmt::format(" --memory {}", arguments.memory);
    return out;
}

std::string command_of(const ChartOptions& o, const std::string& view, const std::string& output) {
    std::string out = fmt::format(
        "manylight chart {} --samplers {} --light-samples {} --spp {} --seeds {} --seed {} "
        "--baseline {} --most-seconds {}",
        view, fmt::join(o.samplers, ","), join(o.light_samples), join(o.spp), o.seeds, o.seed,
        o.baseline, o.most_seconds);
    if (o.whole) out += " --whole";
    if (o.reference_seconds > 0) out += fmt::format(" --reference-time {}", o.reference_seconds);
    return out + " -o " + quote(output);
}

// The ladder in order, each step once; all samplers that take so many lights unless some are named.
ChartOptions complete(ChartOptions options, std::size_t lights) {
    for (std::vector<uint>* steps : {&options.light_samples, &options.spp}) {
        std::ranges::sort(*steps);
        steps->erase(std::unique(steps->begin(), steps->end()), steps->end());
    }
    if (options.whole && options.spp.front() == 1)
        throw InputError(
            "--spp 1: a single pixel sample lies at the pixel's centre; --whole takes two or more");
    std::vector<std::string> samplers;
    for (const Sampler& sampler : all_samplers())
        if (options.samplers.empty()
                ? lights <= sampler.most_lights
                : std::ranges::count(options.samplers, std::string(sampler.name)) > 0)
            samplers.emplace_back(sampler.name);
    options.samplers = samplers;
    const auto charted = [&](const std::string& name) {
        return std::ranges::count(samplers, name) > 0;
    };
    if (options.baseline.empty())
        options.baseline = charted("adaptive") ? "adaptive" : samplers.front();
    else if (!charted(options.baseline))
        throw InputError("--baseline {}: is not among the samplers of the chart ({})",
                         options.baseline, fmt::join(samplers, ", "));
    return options;
}

void write_text(const fs::path& path, const std::string& text) {
    write_file(path.string(), std::as_bytes(std::span(text)));
}

void write_chart(const std::string& output, const Chart& chart, const json& facts,
                 const std::string& report, const std::vector<ShownImage>& shown) {
    const Image reference = chart.reference.image();
    const ErrorEstimate error = chart.reference.error();
    write_chart_folder(output, [&](const std::string& to) {
        const fs::path folder = to;
        for (const ShownImage& s : shown) {
            const Difference d =
                compare_images(unpack(s.image->packed), reference, s.file, "the reference");
            const std::string title =
                fmt::format("{}, {} light samples, {} spp", s.image->setting.sampler,
                            s.image->setting.light_samples, s.image->setting.spp);
            write_png((folder / s.file).string(),
                      draw_error_picture({{title, reference.width, reference.height, d.pixels}}), 1,
                      {});
        }
        write_exr((folder / "reference.exr").string(), {reference, error.pixels},
                  {{"Software", "manylight " MANYLIGHT_VERSION},
                   {"manylight:relmse", static_cast<float>(error.relmse)}});
        write_text(folder / "report.html", report);
        write_text(folder / "chart.json",
                   facts.dump(1, ' ', true, json::error_handler_t::replace) + "\n");
    });
}

void print_summary(const Chart& chart, const std::vector<SettingSummary>& summaries) {
    say("\n{:<24}{:>8}{:>5}{:>11}{:>12}{:>10}{:>10}{:>8}\n", "sampler", "samples", "spp", "seconds",
        "relMSE", "MAPE", "bias", "z");
    for (const SettingSummary& s : summaries)
        say("{:<24}{:>8}{:>5}{:>11.4f}{:>12.3g}{:>10.3g}{:>9.3f}%{:>8}\n", s.setting.sampler,
            s.setting.light_samples, s.setting.spp, s.seconds.median, s.relmse.median,
            s.mape.median, 100 * s.bias, s.z ? fmt::format("{:.1f}", *s.z) : "-");
    for (const LeftOut& left : chart.left_out)
        say("left out: {}, {} light samples, {} spp: {}\n", left.setting.sampler,
            left.setting.light_samples, left.setting.spp, left.reason);
    const double own = chart.reference.error().relmse;
    say("\nreference: {}, {} spp, its own relMSE {:.3g}; the smallest that it judges {:.3g}\n",
        chart.reference_setting.sampler, chart.reference_setting.spp * chart.reference.count(), own,
        chart.smallest_error);
}

}  // namespace

int run_chart(const ChartArguments& arguments) {
    const auto start = Clock::now();
    std::string output = arguments.output;
    if (output.empty()) output = fs::path(arguments.scene.file).stem().string() + "-chart";
    check_chart_folder("--output", output);
    SceneArguments scene = arguments.scene;
    if (scene.width == 0 && scene.height == 0) scene.height = default_height;
    const LoadedScene loaded = load(scene, arguments.options.quiet);
    const ChartOptions options = complete(arguments.options, loaded.scene.lights.size());
    if (loaded.scene.lights.empty())
        throw InputError(
            "{}: has no lights{}: samplers have none to choose from, and there is nothing to "
            "compare (--headlight always adds one)",
            loaded.scene.file, is_dark(loaded.scene) ? "" : ", but surfaces that are unlit");
    const double load_seconds = seconds_since(start);
    const Device device = Device::open(scene.device, scene.threads, scene.lanes);
    const auto build_start = Clock::now();
    const WideBvh bvh = build_bvh(loaded, device, options.quiet);
    const double bvh_seconds = seconds_since(build_start);
    Renderer renderer(
        device, loaded.scene, bvh, loaded.camera, loaded.width, loaded.height, arguments.memory,
        options.whole ? std::optional(WholePixels{seconds_since(start)}) : std::nullopt);
    if (!options.quiet)
        say("{}: {} triangles, {} lights, camera '{}', {} x {}\n{} ({})\n", loaded.scene.file,
            loaded.scene.seen_triangle_count(), loaded.scene.lights.size(), loaded.view.name,
            loaded.width, loaded.height, device.info().name, device.info().platform);
    const Chart chart = measure_chart(renderer, options);
    const std::vector<SettingSummary> summaries = summarise(chart);
    const std::vector<ShownImage> shown = choose_images(chart, summaries);
    const std::string view = view_options(arguments, loaded);
    json facts = chart_json(chart, renderer, summaries, shown,
                            {.scene = {{"file", loaded.scene.file},
                                       {"camera", loaded.view.name},
                                       {"triangles", loaded.scene.seen_triangle_count()},
                                       {"lights", loaded.scene.lights.size()},
                                       {"emitter_points", loaded.emitter_points}},
                             .seconds = {{"load", load_seconds}, {"bvh", bvh_seconds}},
                             .command = command_of(chart.options, view, output),
                             .view = view});
    facts["files"] = {"chart.json", "report.html", "reference.exr"};
    for (const ShownImage& s : shown) facts["files"].push_back(s.file);
    facts["seconds"]["total"] = seconds_since(start);
    const std::string report = make_report(facts, chart.reference.image(), shown);
    write_chart(output, chart, facts, report, shown);
    const double own = chart.reference.error().relmse;
    if (own * reference_ratio > chart.smallest_error && chart.smallest_error > 0)
        warn(
            "the reference's own relMSE {:.3g} is only {:.3g} times below the "
            "smallest that it judges",
            own, chart.smallest_error / own);
    if (options.quiet) return 0;
    print_summary(chart, summaries);
    say("{:.0f} s; wrote {}\n", seconds_since(start), (fs::path(output) / "report.html").string());
    return 0;
}

}  // namespace manylight

// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <thread>

#include "bench/traversal.hpp"
#include "clock.hpp"
#include "commands/commands.hpp"
#include "error.hpp"
#include "output/progress.hpp"
#include "output/write_file.hpp"
#include "print.hpp"
#include "scene/builtin/builtin.hpp"
#include "scene/gltf/parse.hpp"
#include "stages/gbuffer.hpp"
#include "verify/verify.hpp"

namespace manylight {
namespace {

using nlohmann::json;

constexpr double most_differences = 1e-4;  // of the rays that the reference judges
constexpr unsigned builds = 3;

// The dragon's room, with the mesh if one is given.
LoadedScene load_room(const BenchArguments& arguments) {
    SceneArguments scene = arguments.scene;
    struct TemporaryFile {
        std::filesystem::path path = std::filesystem::temp_directory_path() /
                                     fmt::format("manylight-bench-{}.glb", getpid());
        ~TemporaryFile() {
            std::error_code ignored;
            std::filesystem::remove(path, ignored);
        }
    } const file;
    make_builtin("dragon", {.mesh = arguments.mesh}).write(file.path.string());
    scene.file = file.path.string();
    scene.camera = arguments.view.empty() ? "far" : arguments.view;
    LoadedScene loaded = load(scene);
    loaded.scene.file = arguments.mesh.empty() ? "dragon" : "dragon with " + arguments.mesh;
    return loaded;
}

double rate(std::size_t rays, const TracingResult& tracing) {
    return static_cast<double>(rays) / quartiles(tracing.seconds).median / 1e6;
}

// How many times as fast one way is as another, round by round.
Quartiles ratio(const TracingResult& of, const TracingResult& to) {
    std::vector<double> paired;
    for (std::size_t i = 0; i < of.seconds.size(); ++i)
        paired.push_back(to.seconds[i] / of.seconds[i]);
    return quartiles(paired);
}

void check_hits(const RaySetResult& set, const TracingResult& tracing) {
    if (static_cast<double>(tracing.differences) >
        most_differences * static_cast<double>(set.judged))
        throw RuntimeError("{}, {}: {} of {} rays differ from the reference: no figures", set.name,
                           tracing.name, tracing.differences, set.judged);
}

json to_json(const RaySetResult& set, const TracingResult& tracing) {
    const Quartiles seconds = quartiles(tracing.seconds);
    const auto mega = static_cast<double>(set.rays) / 1e6;
    return {{"mrays_per_s", mega / seconds.median},
            {"quartiles", {mega / seconds.upper, mega / seconds.lower}},
            {"differences", tracing.differences}};
}

void print(const RaySetResult& set, const TracingResult& used) {
    say("\n{}: {} rays, {} of them judged by the reference\n", set.name, set.rays, set.judged);
    for (const auto* list : {&set.kernels, &set.embree})
        for (const TracingResult& tracing : *list) {
            say("  {:<28}{:8.2f} Mrays/s", tracing.name, rate(set.rays, tracing));
            if (list == &set.embree) {
                const Quartiles r = ratio(used, tracing);
                say("   ours / this {:.2f} ({:.2f} to {:.2f})", r.median, r.lower, r.upper);
            }
            say("\n");
        }
}

void add_ratios(const RaySetResult& set, const TracingResult& used, json& ratios) {
    if (set.embree.empty()) return;
    const TracingResult& best = *std::ranges::min_element(
        set.embree, {}, [](const TracingResult& t) { return quartiles(t.seconds).median; });
    const Quartiles single = ratio(used, set.embree.front());
    const Quartiles over = ratio(used, best);
    ratios[set.name] = {{"over_single", single.median},
                        {"over_single_quartiles", {single.lower, single.upper}},
                        {"over_best", over.median},
                        {"over_best_quartiles", {over.lower, over.upper}},
                        {"best", best.name}};
}

WideBvh build(const LoadedScene& loaded, const BenchArguments& arguments, const Device& device) {
    const unsigned lanes = device.form().bvh_width;
    return build_wide_bvh(loaded.scene, arguments.bvh_width ? arguments.bvh_width : lanes,
                          arguments.bvh_block ? arguments.bvh_block : lanes,
                          reach_of(loaded.scene, loaded.camera));
}

// What loading and building a file takes beyond what must be: its parser alone and the BVH.
void bench_loading(const SceneArguments& scene, const Device& device, json& out) {
    std::vector<double> loads, builds_alone, parsers, ratios;
    long peak = 0;  // KiB
    for (unsigned i = 0; i < builds; ++i) {
        const auto start = Clock::now();
        {
            const LoadedScene loaded = load(scene);
            loads.push_back(seconds_since(start));
            const WideBvh bvh = build_bvh(loaded, device);
            builds_alone.push_back(seconds_since(start) - loads.back());
        }
        if (i == 0) {
            rusage usage{};
            getrusage(RUSAGE_SELF, &usage);
            peak = usage.ru_maxrss;
        }
        const auto parse_start = Clock::now();
        parse_alone(scene.file);
        parsers.push_back(seconds_since(parse_start));
        ratios.push_back((loads.back() + builds_alone.back()) /
                         (parsers.back() + builds_alone.back()));
    }
    const double of_file = static_cast<double>(peak) * 1024 /
                           static_cast<double>(std::filesystem::file_size(scene.file));
    out["loading"] = {{"load_s", quartiles(loads).median},
                      {"build_s", quartiles(builds_alone).median},
                      {"parser_s", quartiles(parsers).median},
                      {"ratio", quartiles(ratios).median},
                      {"peak_bytes", peak * 1024},
                      {"peak_over_file", of_file}};
    say("loading {:.3f} s (tinygltf alone {:.3f} s), BVH {:.3f} s: {:.2f} times what tinygltf and "
        "the BVH take; memory of the process {:.1f} MiB, {:.2f} times the file\n",
        quartiles(loads).median, quartiles(parsers).median, quartiles(builds_alone).median,
        quartiles(ratios).median, static_cast<double>(peak) / 1024, of_file);
}

// Builds both BVHs in turn; the last ones are kept.
WideBvh measure_builds(const LoadedScene& loaded, const BenchArguments& arguments,
                       const Device& device, unsigned threads, std::optional<EmbreeScene>& embree,
                       json& out) {
    WideBvh bvh;
    std::vector<double> ours;
    std::vector<double> theirs;
    for (unsigned i = 0; i < builds; ++i) {
        const auto start = Clock::now();
        bvh = build(loaded, arguments, device);
        ours.push_back(seconds_since(start));
        if (!EmbreeScene::available() || !loaded.scene.shared_meshes.empty()) continue;
        embree.emplace(loaded.scene, threads);
        theirs.push_back(embree->build_seconds());
    }
    const std::size_t bytes = (bvh.nodes.size() + bvh.blocks.size()) * sizeof(float);
    out["bvh"] = {{"width", bvh.width},
                  {"block", bvh.block},
                  {"build_s", quartiles(ours).median},
                  {"memory_bytes", bytes}};
    say("BVH of width {}, blocks of {}: {:.3f} s, {:.1f} MiB\n", bvh.width, bvh.block,
        quartiles(ours).median, static_cast<double>(bytes) / (1 << 20));
    if (embree) {
        out["embree"] = {{"build_s", quartiles(theirs).median},
                         {"memory_bytes", embree->memory_bytes()}};
        say("Embree's, of medium quality: {:.3f} s, {:.1f} MiB\n", quartiles(theirs).median,
            static_cast<double>(embree->memory_bytes()) / (1 << 20));
    } else {
        say("{}: nothing to compare with\n",
            EmbreeScene::available() ? "Embree gets no instances here" : "built without Embree");
    }
    return bvh;
}

void bench_traversal(const LoadedScene& loaded, Device& device, const BenchArguments& arguments,
                     json& out) {
    const unsigned threads =
        arguments.scene.threads ? arguments.scene.threads : std::thread::hardware_concurrency();
    std::optional<EmbreeScene> embree;
    const WideBvh bvh = measure_builds(loaded, arguments, device, threads, embree, out);
    const Tiles tiles = all_tiles(loaded.width, loaded.height, 32);
    const DeviceScene scene =
        upload_scene(device, loaded.scene, bvh, loaded.camera, nullptr, item_count(tiles));
    Surface missed{};
    missed.position.w = -1;  // where a tile reaches beyond the image
    Buffer<Surface> surfaces = device.upload(std::vector<Surface>(item_count(tiles), missed));
    GBufferStage(device, scene).trace(tiles, {}, surfaces);
    const std::vector<Surface> hits = surfaces.download();
    const reference::Tracer tracer(loaded.scene);
    const DeviceTracer kernels(device, scene);
    const float reach = reach_of(loaded.scene, loaded.camera);
    for (const RaySet& set :
         {primary_rays(loaded.camera, tiles), incoherent_shadow_rays(loaded.scene, hits),
          coherent_shadow_rays(loaded.scene, hits)}) {
        if (set.ray_count() == 0) continue;
        const std::vector<Tracing> theirs =
            embree ? embree->interfaces(set.any_hit) : std::vector<Tracing>{};
        const double steps = (arguments.rounds + 1.0) * (2 + static_cast<double>(theirs.size()));
        double done = 0;
        const RaySetResult result = [&] {
            Progress progress("tracing " + set.name);
            return measure(set, tracer, reach, kernels.tracings(set.any_hit), theirs,
                           arguments.rounds, [&] { progress.set(++done / steps); });
        }();
        const TracingResult& used =
            result.kernels[!set.any_hit && scene.packets && !scene.primary_packets ? 1 : 0];
        json& rays = out["rays"][set.name];
        rays["count"] = result.rays;
        for (const auto* list : {&result.kernels, &result.embree})
            for (const TracingResult& tracing : *list) {
                check_hits(result, tracing);
                rays[tracing.name] = to_json(result, tracing);
            }
        print(result, used);
        add_ratios(result, used, out["ratios"]);
    }
}

void bench_stages(const LoadedScene& loaded, const Device& device, const BenchArguments& arguments,
                  json& out) {
    VerifyOptions verify_options;
    const double scale = 96.0 / std::max(loaded.width, loaded.height);
    verify_options.width = std::max(1u, static_cast<unsigned>(loaded.width * scale));
    verify_options.height = std::max(1u, static_cast<unsigned>(loaded.height * scale));
    const Camera small = make_camera(loaded.view, verify_options.width, verify_options.height);
    for (const Check& check : Verifier(device, loaded.scene, small, verify_options).all())
        if (!check.passed())
            throw RuntimeError("{}: differs from the reference ({}): no figures", check.stage,
                               check.first_failure);
    RenderOptions options;
    options.sampler = arguments.sampler;
    options.light_samples = arguments.light_samples;
    options.spp = 1;
    options.width = loaded.width;
    options.height = loaded.height;
    const WideBvh bvh = build(loaded, arguments, device);
    std::map<std::string, std::vector<double>> seconds;
    std::vector<double> totals;
    std::size_t shadow_rays = 0;
    Device measured = device;
    for (unsigned round = 0; round <= arguments.rounds; ++round) {
        const std::map<std::string, double> before = measured.stage_seconds();
        Frame frame(measured, loaded.scene, bvh, loaded.camera, options);
        frame.prepare();
        Progress quiet("", true);
        const FrameResult result = frame.render(quiet);
        if (round == 0) continue;  // compiles
        shadow_rays = result.shadow_rays;
        double total = 0;
        for (const auto& [stage, after] : measured.stage_seconds()) {
            const double took = after - (before.contains(stage) ? before.at(stage) : 0);
            if (took <= 0) continue;
            seconds[stage].push_back(took);
            total += took;
        }
        totals.push_back(total);
    }
    const double total = quartiles(totals).median;
    say("\nstages, {}, {} light samples, 1 spp, {} x {} (all verified)\n", options.sampler,
        options.light_samples, loaded.width, loaded.height);
    for (const auto& [stage, times] : seconds) {
        const double median = quartiles(times).median;
        say("  {:<18}{:9.4f} s {:6.1f} %\n", stage, median, 100 * median / total);
        out["stages"][stage] = {{"seconds", median}, {"share", median / total}};
    }
    if (shadow_rays == 0) return;
    const double shadow_rate =
        static_cast<double>(shadow_rays) / quartiles(seconds.at("shadows")).median / 1e6;
    say("  {:<18}{:9.4f} s\n  shadow rays: {}, {:.2f} Mrays/s\n", "all", total, shadow_rays,
        shadow_rate);
    out["stages"]["shadow_mrays_per_s"] = shadow_rate;
}

void write_json(const std::string& path, const json& out) {
    if (path.empty()) return;
    const std::string text = out.dump(2, ' ', true, json::error_handler_t::replace) + "\n";
    write_file(path, std::as_bytes(std::span(text)));
    say("\nwrote {}\n", path);
}

}  // namespace

int run_bench(const BenchArguments& arguments) {
    const bool traversal = arguments.what == "traversal";
    const bool stages = arguments.what == "stages";
    const bool file = !traversal && !stages;
    for (const auto& [option, value] :
         {std::pair{"--mesh", &arguments.mesh}, std::pair{"--view", &arguments.view}})
        if (file && !value->empty())
            throw InputError(
                "{} {}: goes with 'bench traversal' or 'bench stages', not with a file", option,
                *value);
    if (!file && !arguments.scene.camera.empty())
        throw InputError("--camera {}: goes with a file; the dragon's room has --view",
                         arguments.scene.camera);
    if (!arguments.json.empty()) {
        check_output("--json", arguments.json);
        for (const std::string& input : {arguments.what, arguments.mesh})
            if (same_file(arguments.json, input))
                throw InputError("--json {}: is the scene itself", arguments.json);
    }
    if (!file && arguments.loading)
        throw InputError("--loading: goes with a file, not with 'bench {}'", arguments.what);
    BenchArguments with_file = arguments;
    with_file.scene.file = arguments.what;
    Device device =
        Device::open(arguments.scene.device, arguments.scene.threads, arguments.scene.lanes);
    if (arguments.loading) {
        json loading;
        bench_loading(with_file.scene, device, loading);
        write_json(arguments.json, loading);
        return 0;
    }
    const LoadedScene loaded = file ? load(with_file.scene) : load_room(arguments);
    if (loaded.scene.lights.empty())
        throw InputError("{}: has no lights: there are no shadow rays to measure",
                         loaded.scene.file);
    say("{}: {} triangles, {} lights, camera '{}', {} x {}\n{} ({})\n", loaded.scene.file,
        loaded.scene.seen_triangle_count(), loaded.scene.lights.size(), loaded.view.name,
        loaded.width, loaded.height, device.info().name, device.info().platform);
    json out = {{"version", MANYLIGHT_VERSION},
                {"scene", loaded.scene.file},
                {"view", loaded.view.name},
                {"triangles", loaded.scene.seen_triangle_count()},
                {"lights", loaded.scene.lights.size()},
                {"width", loaded.width},
                {"height", loaded.height},
                {"device", device.info().name},
                {"platform", device.info().platform},
                {"rounds", arguments.rounds}};
    if (!stages) bench_traversal(loaded, device, arguments, out);
    if (!traversal) bench_stages(loaded, device, arguments, out);
    write_json(arguments.json, out);
    return 0;
}

}  // namespace manylight

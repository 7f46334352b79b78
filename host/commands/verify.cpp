// SPDX-License-Identifier: MIT
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <span>
#include <sstream>

#include "commands/commands.hpp"
#include "error.hpp"
#include "output/progress.hpp"
#include "output/write_file.hpp"
#include "print.hpp"
#include "verify/verify_all.hpp"

namespace manylight {
namespace {

using nlohmann::json;

void print_failure(const Check& c, const std::string& scene) {
    if (c.failed > 0)
        say("    {}{} of {} items differ; the first: {}\n", scene, c.failed, c.items,
            c.first_failure);
    else if (!c.passed())
        say("    {}{} of {} items are borderline: too many\n", scene, c.borderline, c.items);
}

// A stage's checks on all scenes as one row; what fails is told scene by scene.
struct StageRow {
    Check sum;
    bool failed = false;
    std::vector<std::pair<std::string, const Check*>> checks;  // with their scenes
};

std::vector<StageRow> rows_of(const Verification& found) {
    std::vector<StageRow> rows;
    for (const SceneChecks& scene : found.scenes)
        for (const Check& c : scene.checks) {
            auto row = std::ranges::find_if(
                rows, [&](const StageRow& r) { return r.sum.stage == c.stage; });
            if (row == rows.end())
                row = rows.insert(
                    rows.end(), StageRow{{.stage = c.stage, .tolerance = c.tolerance}, false, {}});
            row->sum.items += c.items;
            row->sum.telling += c.telling;
            row->sum.borderline += c.borderline;
            row->sum.largest = std::max(row->sum.largest, c.largest);
            row->failed = row->failed || !c.passed();
            row->checks.emplace_back(scene.name, &c);
        }
    return rows;
}

void print_table(const Verification& found) {
    say("{:<32} {:>8} {:>10} {:>10}  {:<6} {}\n", "stage", "items", "borderline", "largest", "",
        "tolerance");
    const bool one = found.scenes.size() == 1;
    for (const StageRow& row : rows_of(found)) {
        const Check& sum = row.sum;
        const char* verdict = row.failed ? "FAIL" : sum.telling > 0 ? "pass" : "-";
        say("{:<32} {:>8} {:>10} {:>10.3g}  {:<6} {}\n", sum.stage, sum.items, sum.borderline,
            sum.largest, verdict, sum.tolerance);
        if (!row.failed && sum.telling == 0)
            say("    {} does not test it\n", one ? "this scene" : "no scene");
        for (const auto& [scene, check] : row.checks)
            print_failure(*check, one ? "" : scene + ": ");
    }
}

json to_json(const Check& c) {
    json out = {{"stage", c.stage},           {"items", c.items},
                {"telling", c.telling},       {"failed", c.failed},
                {"borderline", c.borderline}, {"largest", c.largest},
                {"tolerance", c.tolerance},   {"verdict", c.tested() ? "pass" : "not tested"}};
    if (!c.passed()) out["verdict"] = "fail";
    if (c.failed > 0) out["first_failure"] = c.first_failure;
    return out;
}

json kernels_json(const Coverage& coverage) {
    json out = json::array();
    for (const KernelCode& kernel : all_kernels()) {
        const char* state = "not tested";
        switch (coverage.state(kernel)) {
            case Coverage::State::tested:
                state = "tested";
                break;
            case Coverage::State::not_tested:
                break;
            case Coverage::State::other_form:
                state = "of another form";
                break;
            case Coverage::State::not_rendering:
                state = "not part of rendering";
                break;
        }
        out.push_back({{"file", kernel.file},
                       {"kernel", kernel.name},
                       {"state", state},
                       {"features", kernel.features},
                       {"not_tested_with", coverage.missing(kernel, true)},
                       {"not_tested_without", coverage.missing(kernel, false)}});
    }
    return out;
}

json to_json(const Verification& found, const Device& device) {
    const DeviceInfo& info = device.info();
    const std::vector<std::string> left = found.not_tested();
    json scenes = json::array();
    for (const SceneChecks& scene : found.scenes) {
        json checks = json::array();
        for (const Check& c : scene.checks) checks.push_back(to_json(c));
        scenes.push_back({{"scene", scene.name},
                          {"summary", scene.summary},
                          {"triangles", scene.triangles},
                          {"lights", scene.lights},
                          {"width", scene.width},
                          {"height", scene.height},
                          {"checks", std::move(checks)}});
    }
    return {{"version", MANYLIGHT_VERSION},
            {"device", info.name},
            {"platform", info.platform},
            {"opencl", info.version},
            {"driver", info.driver},
            {"lanes", device.form().lanes},
            {"scenes", std::move(scenes)},
            {"kernels", kernels_json(found.coverage)},
            {"not_tested", left},
            {"verdict", !found.passed() ? "wrong"
                        : left.empty()  ? "correct"
                                        : "incomplete"}};
}

void print_device(const DeviceInfo& info) {
    say("{}: {}, {}, driver {}\n", info.name, info.platform, info.version, info.driver);
    if (const std::string hint = known_trouble(info); !hint.empty())
        say("known trouble: {}\n", hint);
}

Verification verify_file(const LoadedScene& loaded, Device device, const VerifyOptions& options) {
    Verification found{{}, Coverage(device.form().lanes > 1), false};
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

int run_verify(const VerifyArguments& arguments) {
    SceneArguments scene = arguments.scene;
    const bool built_in = scene.file.empty();
    check_json(arguments);
    if (built_in) refuse_without_file(scene);
    VerifyOptions options;
    options.seed = arguments.seed;
    options.clusters = arguments.clusters;
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
        print_table(found);
        say("\nlargest: the largest difference from the scalar reference, over its tolerance (eps: "
            "2^-23).\nborderline: items that rounding of their rays' ends decides either "
            "way.\n");
        std::istringstream verdict(found.verdict());
        for (std::string line; std::getline(verdict, line);) say("{}\n", line);
    }
    if (!arguments.json.empty()) write_json(arguments.json, to_json(found, device));
    return found.passed() ? 0 : 3;
}

}  // namespace manylight

// SPDX-License-Identifier: MIT
#include "commands/verify_report.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "commands/repeat.hpp"
#include "print.hpp"

namespace manylight {

using nlohmann::json;

std::string repeat_command(const VerifyArguments& arguments, const SceneChecks& scene,
                           const Check& check) {
    const SceneArguments& seen = arguments.scene;
    const ClusterOptions& clusters = arguments.clusters;
    const ClusterOptions usual;
    Selection only;
    only.stages = {stage_of(check)};
    if (!check.sampler.empty()) only.samplers = {check.sampler};
    if (!scene.scene.empty()) only.scenes = {scene.scene};
    std::string out = "manylight verify";
    if (!seen.file.empty()) out += " " + view_words(seen);
    out += fmt::format(" --device {} --device-form {}", quote(seen.device),
                       seen.lanes == 1 ? "gpu" : fmt::to_string(seen.lanes));
    if (seen.threads > 0) out += fmt::format(" --threads {}", seen.threads);
    out +=
        fmt::format(" --width {} --height {} --seed {}", seen.width, seen.height, arguments.seed);
    const auto add = [&](const char* option, auto value, auto otherwise) {
        if (value != otherwise) out += fmt::format(" --{} {}", option, value);
    };
    add("tile-size", clusters.tile_size, usual.tile_size);
    add("max-depth", clusters.max_depth, usual.max_depth);
    add("normal-threshold", clusters.normal_threshold, usual.normal_threshold);
    add("visibility-threshold", clusters.shadow.threshold, usual.shadow.threshold);
    return out + " " + only.words();
}

namespace {

void print_failure(const Check& c, const std::string& scene) {
    if (c.failed > 0)
        say("    {}{} of {} items differ; the first: {}\n", scene, c.failed, c.items,
            c.first_failure);
    else
        say("    {}{} of {} items are borderline: too many\n", scene, c.borderline, c.items);
}

// A stage's checks on all scenes as one row; what fails is told scene by scene.
struct StageRow {
    Check sum;
    bool failed = false;
    std::vector<std::pair<const SceneChecks*, const Check*>> checks;
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
            row->checks.emplace_back(&scene, &c);
        }
    return rows;
}

}  // namespace

void print_table(const Verification& found, const VerifyArguments& arguments) {
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
        std::string last;  // one command repeats a scene's, however it is seen
        for (const auto& [scene, check] : row.checks) {
            if (check->passed()) continue;
            print_failure(*check, one ? "" : scene->name + ": ");
            const std::string command = repeat_command(arguments, *scene, *check);
            if (command != last) say("    to repeat it: {}\n", command);
            last = command;
        }
    }
}

namespace {

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

}  // namespace

json to_json(const Verification& found, const VerifyArguments& arguments, const Device& device) {
    const DeviceInfo& info = device.info();
    const std::vector<std::string> left = found.not_tested();
    json scenes = json::array();
    for (const SceneChecks& scene : found.scenes) {
        json checks = json::array();
        for (const Check& c : scene.checks) {
            checks.push_back(to_json(c));
            if (!c.passed()) checks.back()["repeat"] = repeat_command(arguments, scene, c);
        }
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

}  // namespace manylight

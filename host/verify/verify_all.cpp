// SPDX-License-Identifier: MIT
#include "verify/verify_all.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "verify/scenes.hpp"
#include "verify/stages.hpp"

namespace manylight {

bool Verification::passed() const {
    return std::ranges::all_of(scenes, [](const SceneChecks& scene) {
        return std::ranges::all_of(scene.checks, [](const Check& c) { return c.passed(); });
    });
}

// A single scene has one form of each kernel: what is left out of it is compiled out.
std::vector<std::string> Verification::not_tested() const {
    if (only.everything()) return coverage.not_tested(complete);
    std::vector<std::string> out = coverage.silent_stages();
    out.push_back("all that is not selected by " + only.words());
    return out;
}

std::string Verification::verdict() const {
    if (!passed()) return "The device does NOT compute correctly.";
    const std::vector<std::string> left = not_tested();
    if (left.empty()) return "The device computes correctly.";
    const char* found = !only.everything() ? "No error was found in what was selected."
                        : complete         ? "No error was found, but the test has gaps."
                                           : "No error was found in what this scene tests.";
    return fmt::format("{} Not tested:\n  {}", found, fmt::join(left, "\n  "));
}

namespace {

// The scene of check_blend(), and the stages that it judges.
constexpr const char* blend_name = "veil";
constexpr std::string_view blend_stages[] = {"gbuffer", "samples"};

// A scene as it is seen, and the stages that are judged there.
struct Visit {
    std::string name;
    const VerifyScene* made;
    View view;
    bool receivers;
    std::vector<const StageCheck*> rows;
};

std::vector<Visit> visits_of(const std::vector<VerifyScene>& scenes, const Selection& only) {
    std::vector<Visit> visits;
    for (const VerifyScene& made : scenes) {
        if (!only.takes_scene(made.name)) continue;
        const auto add = [&](const char* what, const View& view, bool StageCheck::*where) {
            Visit visit{made.name + what, &made, view, where == &StageCheck::receivers,
                        selected_stages(only, where)};
            if (!visit.rows.empty()) visits.push_back(std::move(visit));
        };
        add("", made.view, nullptr);
        // What a camera changes: where rays start, and which kernel traces them.
        add(", orthographic", without_perspective(made.view), &StageCheck::orthographic);
        // Points that are no pixels: which kernels light them.
        if (made.name == "mirrors")
            add(", receivers that no camera sees", made.view, &StageCheck::receivers);
    }
    return visits;
}

SceneChecks judge(Device device, const Visit& visit, VerifyOptions options) {
    options.receivers = visit.receivers;
    const Scene& scene = visit.made->scene;
    Verifier verifier(device, scene, make_camera(visit.view, options.width, options.height),
                      options);
    return {
        visit.name,    visit.made->summary, scene.seen_triangle_count(),      scene.lights.size(),
        options.width, options.height,      run_stages(verifier, visit.rows), visit.made->name};
}

// What is there by chance; nothing where the options select nothing of it.
std::optional<SceneChecks> judge_blend(Device device, const VerifyOptions& options) {
    const Selection& only = options.only;
    if (!only.takes_scene(blend_name) || !only.takes_one_of(blend_stages) ||
        (only.stages.empty() && !only.samplers.empty()))
        return {};
    SceneChecks found{blend_name, "a shade that is there by chance", 4, 1, 32, 32, {}, blend_name};
    for (Check& check : check_blend(device, options.seed))
        if (only.takes_stage(stage_of(check))) found.checks.push_back(std::move(check));
    return found;
}

}  // namespace

std::vector<std::string> verified_scenes() {
    std::vector<std::string> names;
    for (const VerifyScene& made : verify_scenes()) names.push_back(made.name);
    names.emplace_back(blend_name);
    return names;
}

Verification verify_all(Device device, const VerifyOptions& options,
                        const std::function<void(double)>& progress) {
    Verification out{{}, Coverage(device.form().lanes > 1), true, options.only};
    const std::vector<VerifyScene> scenes = verify_scenes();
    const std::vector<Visit> visits = visits_of(scenes, options.only);
    (void)device.take_launched();
    const auto take = [&](SceneChecks found) {
        out.coverage.add(device.take_launched(), found.checks);
        out.scenes.push_back(std::move(found));
        progress(static_cast<double>(out.scenes.size()) / static_cast<double>(visits.size() + 1));
    };
    for (const Visit& visit : visits) take(judge(device, visit, options));
    if (std::optional<SceneChecks> blend = judge_blend(device, options)) take(std::move(*blend));
    return out;
}

}  // namespace manylight

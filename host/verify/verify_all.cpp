// SPDX-License-Identifier: MIT
#include "verify/verify_all.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "verify/scenes.hpp"

namespace manylight {

bool Verification::passed() const {
    return std::ranges::all_of(scenes, [](const SceneChecks& scene) {
        return std::ranges::all_of(scene.checks, [](const Check& c) { return c.passed(); });
    });
}

// A single scene has one form of each kernel: what is left out of it is compiled out.
std::vector<std::string> Verification::not_tested() const { return coverage.not_tested(complete); }

std::string Verification::verdict() const {
    if (!passed()) return "The device does NOT compute correctly.";
    const std::vector<std::string> left = not_tested();
    if (left.empty()) return "The device computes correctly.";
    return fmt::format("{} Not tested:\n  {}",
                       complete ? "No error was found, but the test has gaps."
                                : "No error was found in what this scene tests.",
                       fmt::join(left, "\n  "));
}

Verification verify_all(Device device, const VerifyOptions& options,
                        const std::function<void(double)>& progress) {
    Verification out{{}, Coverage(device.form().lanes > 1), true};
    const std::vector<VerifyScene> scenes = verify_scenes();
    (void)device.take_launched();
    const auto take = [&](SceneChecks found) {
        out.coverage.add(device.take_launched(), found.checks);
        out.scenes.push_back(std::move(found));
        progress(static_cast<double>(out.scenes.size()) /
                 (2 * static_cast<double>(scenes.size()) + 2));
    };
    for (const VerifyScene& made : scenes) {
        SceneChecks found{made.name,
                          made.summary,
                          made.scene.seen_triangle_count(),
                          made.scene.lights.size(),
                          options.width,
                          options.height,
                          {}};
        const auto verifier = [&](const View& view) {
            const Camera camera = make_camera(view, options.width, options.height);
            return Verifier(device, made.scene, camera, options);
        };
        found.checks = verifier(made.view).all();
        take(found);
        // What a camera changes: where rays start, and which kernel traces them.
        Verifier flat = verifier(without_perspective(made.view));
        found.name += ", orthographic";
        found.checks = {flat.gbuffer(false), flat.gbuffer(true), flat.contributions()};
        for (Check& check : flat.all_reflections()) found.checks.push_back(std::move(check));
        take(found);
        // Points that are no pixels: which kernels light them.
        if (made.name != "mirrors") continue;
        VerifyOptions of_receivers = options;
        of_receivers.receivers = true;
        Verifier lit(device, made.scene, make_camera(made.view, options.width, options.height),
                     of_receivers);
        found.name = made.name + ", receivers that no camera sees";
        found.checks = lit.lighting();
        found.checks.push_back(lit.contributions());
        take(found);
    }
    take({"veil", "a shade that is there by chance", 4, 1, 32, 32,
          check_blend(device, options.seed)});
    return out;
}

}  // namespace manylight

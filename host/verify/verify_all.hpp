// SPDX-License-Identifier: MIT
// All kernels on scenes of the program's own.
#pragma once

#include <functional>

#include "verify/coverage.hpp"

namespace manylight {

/// What was found on one scene.
struct SceneChecks {
    std::string name;  // a built-in scene's, or the file's
    std::string summary;
    std::size_t triangles = 0, lights = 0;
    unsigned width = 0, height = 0;
    std::vector<Check> checks;
    std::string scene = {};  // as --scene names it; empty: the file's
};

/// What was found on a device.
struct Verification {
    std::vector<SceneChecks> scenes;
    Coverage coverage;

    bool complete = false;  // whether the scenes are meant to leave nothing out
    Selection only = {};    // what was judged

    /// No check failed.
    [[nodiscard]] bool passed() const;
    /// What no scene told anything about, in words.
    [[nodiscard]] std::vector<std::string> not_tested() const;
    /// Says that the device computes correctly only where nothing failed and nothing was left out;
    /// otherwise that something failed, or what was left out, by a selection too.
    [[nodiscard]] std::string verdict() const;
};

/// The scenes of verify_all() as --scene names them.
[[nodiscard]] std::vector<std::string> verified_scenes();

/// Judges every stage on every scene of verify_scenes(), each seen with perspective and, where a
/// stage's row says so, without, and the chance by which rays pass what is partly there: of all
/// that, what the options select. Images have the options' size. `progress` gets the share that is
/// done.
[[nodiscard]] Verification verify_all(Device device, const VerifyOptions& options,
                                      const std::function<void(double)>& progress);

/// Counts an item: a count among trials of a known chance. 5 standard deviations, its tolerance,
/// are exceeded once in two million.
void compare_share(Check& check, double count, double trials, double chance,
                   const std::string& what);

/// Stages gbuffer and samples where rays pass by chance, told from the mean.
[[nodiscard]] std::vector<Check> check_blend(Device device, uint seed);

}  // namespace manylight

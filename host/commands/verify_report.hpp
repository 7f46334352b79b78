// SPDX-License-Identifier: MIT
// What `verify` prints and writes of what it found.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "commands/commands.hpp"
#include "verify/verify_all.hpp"

namespace manylight {

/// The command that repeats one check of a scene. `arguments` are complete: with the device, its
/// form, and the image's size.
[[nodiscard]] std::string repeat_command(const VerifyArguments& arguments, const SceneChecks& scene,
                                         const Check& check);

/// Prints a row for each stage; below one that fails, scene by scene, the first item that differs
/// and, once for each scene, the command that repeats the check.
void print_table(const Verification& found, const VerifyArguments& arguments);

/// The same and which kernels were tested.
[[nodiscard]] nlohmann::json to_json(const Verification& found, const VerifyArguments& arguments,
                                     const Device& device);

}  // namespace manylight

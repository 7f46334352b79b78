// SPDX-License-Identifier: MIT
// Each adds a command to the program: its options, and what runs it, as `run`, once they are
// parsed.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

#include "commands/commands.hpp"

namespace manylight::options {

void add_render(CLI::App& app, std::function<int()>& run);
void add_inspect(CLI::App& app, std::function<int()>& run);
void add_verify(CLI::App& app, std::function<int()>& run);
void add_bench(CLI::App& app, std::function<int()>& run);
void add_scene_command(CLI::App& app, std::function<int()>& run);
void add_chart(CLI::App& app, std::function<int()>& run);
void add_compare(CLI::App& app, std::function<int()>& run);

/// The options of verify alone.
void add_verify_options(CLI::App& command, VerifyArguments& arguments);

}  // namespace manylight::options

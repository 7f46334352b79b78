// SPDX-License-Identifier: MIT
// What is said of words that are missing, too many or mistyped.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "commands/commands.hpp"

namespace manylight::options {

/// "a, b or c".
[[nodiscard]] std::string list_words(const std::vector<std::string>& words);

[[nodiscard]] std::vector<std::string> names_of_commands(const CLI::App& app);

/// What is wrong with a word that names no command.
[[nodiscard]] std::string unknown_command(const CLI::App& app, const std::string& word);

/// What is wrong with words that no option takes.
[[nodiscard]] std::string unknown_words(const CLI::App& app);

/// Throws InputError for a missing argument: `what` it is.
void require(const CLI::App& command, bool is_there, const std::string& what);

/// Throws InputError for a word, given by `option`, that is none of `words`.
void require_word(const std::string& option, const std::string& word,
                  const std::vector<std::string>& words);

void require_scene(const CLI::App& command, const SceneArguments& scene);

}  // namespace manylight::options

// SPDX-License-Identifier: MIT
#include "commands/options/words.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "error.hpp"

namespace manylight::options {

std::string list_words(const std::vector<std::string>& words) {
    std::string out;
    for (std::size_t i = 0; i < words.size(); ++i)
        out += (i == 0 ? "" : i + 1 < words.size() ? ", " : " or ") + words[i];
    return out;
}

namespace {

// How many characters to insert, delete, replace or swap with the next take one word to another.
// Source: the optimal string alignment distance (Damerau 1964, Levenshtein 1966).
std::size_t edit_distance(const std::string& a, const std::string& b) {
    std::vector<std::vector<std::size_t>> d(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
    for (std::size_t i = 0; i <= a.size(); ++i)
        for (std::size_t j = 0; j <= b.size(); ++j) {
            if (i == 0 || j == 0) {
                d[i][j] = i + j;
                continue;
            }
            d[i][j] = std::min({d[i - 1][j] + 1, d[i][j - 1] + 1,
                                d[i - 1][j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1)});
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
                d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 1);
        }
    return d[a.size()][b.size()];
}

// "; did you mean X?" where one of the words is near, or begins so; else nothing.
std::string suggestion(const std::string& word, const std::vector<std::string>& words) {
    const std::string* best = nullptr;
    std::size_t least = std::max<std::size_t>(word.size() / 3, 1) + 1;
    for (const std::string& w : words) {
        const bool begins = word.size() >= 3 && w.starts_with(word);
        const std::size_t distance = begins ? 1 : edit_distance(word, w);
        if (distance >= least) continue;
        least = distance;
        best = &w;
    }
    return best == nullptr ? "" : "; did you mean " + *best + "?";
}

}  // namespace

std::vector<std::string> names_of_commands(const CLI::App& app) {
    std::vector<std::string> names;
    for (const CLI::App* command : app.get_subcommands({})) names.push_back(command->get_name());
    return names;
}

std::string unknown_command(const CLI::App& app, const std::string& word) {
    if (word.ends_with(".gltf") || word.ends_with(".glb"))
        return fmt::format("{}: is no command; 'manylight render {}' renders it", word, word);
    return fmt::format("{}: is no command{}", word, suggestion(word, names_of_commands(app)));
}

std::string unknown_words(const CLI::App& app) {
    const std::vector<std::string> words = app.remaining(true);
    if (app.get_subcommands().empty()) {
        const auto first = std::ranges::find_if(words, [](auto& w) { return !w.starts_with("-"); });
        if (first != words.end()) return unknown_command(app, *first);
    }
    const CLI::App& command = app.get_subcommands().empty() ? app : *app.get_subcommands().front();
    const std::string& word = words.front();
    if (!word.starts_with("-"))
        return fmt::format("{}: {}: is one argument too many", command.get_name(), word);
    std::vector<std::string> options;
    for (const CLI::Option* option : command.get_options())
        for (const std::string& name : option->get_lnames()) options.push_back("--" + name);
    const std::string name = word.substr(0, word.find('='));
    const std::string known = suggestion(name, options);
    return fmt::format("{}: {}: there is no such option{}", command.get_name(), name, known);
}

void require(const CLI::App& command, bool is_there, const std::string& what) {
    if (is_there) return;
    throw InputError("{}: {} is missing; 'manylight {} --help' shows examples", command.get_name(),
                     what, command.get_name());
}

void require_word(const std::string& option, const std::string& word,
                  const std::vector<std::string>& words) {
    if (std::ranges::find(words, word) != words.end()) return;
    throw InputError("{}: {} is not {}{}", option, word, list_words(words),
                     suggestion(word, words));
}

void require_scene(const CLI::App& command, const SceneArguments& scene) {
    require(command, !scene.file.empty(), "the scene's file");
}

}  // namespace manylight::options

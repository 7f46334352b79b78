// SPDX-License-Identifier: MIT
// Values of options: what is taken, and what is said of others.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "commands/options/words.hpp"
#include "shared/types.h"

namespace manylight::options {

constexpr std::uint64_t largest_uint = 4294967295;
constexpr uint most_spp = 1 << 20;

/// "2G", "512M", "100000": bytes. Throws CLI::ValidationError.
[[nodiscard]] std::size_t parse_bytes(const std::string& text);

/// "3,-1.5": a shift by pixels. Throws CLI::ValidationError.
[[nodiscard]] std::pair<double, double> parse_shift(const std::string& text);

/// "tau=0.1": a name and a number. Throws CLI::ValidationError.
[[nodiscard]] std::pair<std::string, double> parse_parameter(const std::string& text);

/// "320,200": a pixel. Throws CLI::ValidationError.
[[nodiscard]] std::pair<unsigned, unsigned> parse_pixel(const std::string& text);

/// A whole number within limits; CLI11's own range prints limits of 300 digits.
[[nodiscard]] CLI::Validator whole(std::uint64_t lower, std::uint64_t upper);

[[nodiscard]] CLI::Validator number(double lower, double upper);

[[nodiscard]] CLI::Validator not_empty();

/// From 8 to 128.
[[nodiscard]] CLI::Validator power_of_two();

/// An option whose value is one of a few words. (CLI11's own transformer tells users of its maps.)
template <class T>
void add_choice(CLI::App& command, const std::string& name, T& value,
                const std::map<std::string, T>& choices, const std::string& help) {
    command.add_option_function<std::string>(
        name,
        [name, &value, choices](const std::string& text) {
            std::vector<std::string> words;
            for (const auto& [word, meaning] : choices) words.push_back(word);
            if (!choices.contains(text))
                throw CLI::ValidationError(name, text + " is not " + list_words(words));
            value = choices.at(text);
        },
        help);
}

}  // namespace manylight::options

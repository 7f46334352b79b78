// SPDX-License-Identifier: MIT
#include "commands/options/values.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace manylight::options {

std::size_t parse_bytes(const std::string& text) {
    std::size_t end = 0;
    double number = 0;
    try {
        number = std::stod(text, &end);
    } catch (const std::exception&) {
        end = 0;
    }
    const std::string unit = text.substr(end);
    const std::map<std::string, double> units = {
        {"", 1}, {"K", 1024}, {"M", 1024. * 1024}, {"G", 1024. * 1024 * 1024}};
    if (end == 0 || !units.contains(unit) || !(number > 0) || number * units.at(unit) > 1e15)
        throw CLI::ValidationError("--memory",
                                   text + " is no size; write, for instance, 512M or 2G");
    return static_cast<std::size_t>(number * units.at(unit));
}

std::pair<double, double> parse_shift(const std::string& text) {
    const char* end = text.c_str();
    double values[2] = {};
    for (double& value : values) {
        char* next = nullptr;
        value = std::strtod(end, &next);
        const char separator = &value == values ? ',' : '\0';
        if (next == end || *next != separator || !(std::abs(value) <= 65536))
            throw CLI::ValidationError("--shift",
                                       text + " is no shift; write, for instance, 16,-0.5");
        end = next + 1;
    }
    return {values[0], values[1]};
}

std::pair<std::string, double> parse_parameter(const std::string& text) {
    const std::size_t sign = text.find('=');
    const std::string number = sign == std::string::npos ? "" : text.substr(sign + 1);
    char* end = nullptr;
    const double value = std::strtod(number.c_str(), &end);
    if (sign == 0 || number.empty() || *end != '\0' || !std::isfinite(value))
        throw CLI::ValidationError("--set", text + " is no NAME=VALUE, such as tau=0.1");
    return {text.substr(0, sign), value};
}

CLI::Validator whole(std::uint64_t lower, std::uint64_t upper) {
    return CLI::Validator(
        [lower, upper](std::string& text) {
            const bool digits =
                !text.empty() && text.size() < 19 &&
                std::ranges::all_of(text, [](char c) { return c >= '0' && c <= '9'; });
            if (digits && std::stoull(text) >= lower && std::stoull(text) <= upper)
                return std::string();
            return fmt::format("{} is no whole number from {} to {}", text, lower, upper);
        },
        "");
}

CLI::Validator number(double lower, double upper) {
    return CLI::Validator(
        [lower, upper](std::string& text) {
            char* end = nullptr;
            const double value = std::strtod(text.c_str(), &end);
            if (!text.empty() && *end == '\0' && value >= lower && value <= upper)
                return std::string();
            return fmt::format("{} is no number from {} to {}", text, lower, upper);
        },
        "");
}

CLI::Validator not_empty() {
    return CLI::Validator(
        [](std::string& file) { return std::string(file.empty() ? "the name is empty" : ""); }, "");
}

CLI::Validator power_of_two() {
    return CLI::Validator(
        [](std::string& text) {
            for (const char* allowed : {"8", "16", "32", "64", "128"})
                if (text == allowed) return std::string();
            return text + " is not 8, 16, 32, 64 or 128";
        },
        "");
}

std::pair<unsigned, unsigned> parse_pixel(const std::string& text) {
    const std::size_t comma = text.find(',');
    std::string x = text.substr(0, comma);
    std::string y = comma == std::string::npos ? "" : text.substr(comma + 1);
    const CLI::Validator coordinate = whole(0, 65535);
    if (!coordinate(x).empty() || !coordinate(y).empty())
        throw CLI::ValidationError("--pixel", text + " is no pixel; write, for instance, 320,200");
    return {static_cast<unsigned>(std::stoul(x)), static_cast<unsigned>(std::stoul(y))};
}

}  // namespace manylight::options

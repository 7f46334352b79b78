// SPDX-License-Identifier: MIT
// All that the program says goes through here, so that no name in a file can forge a message or
// command a terminal.
#pragma once

#include <fmt/format.h>

#include <cstdio>
#include <string>
#include <string_view>
#include <type_traits>

namespace manylight {

/// Text from elsewhere as messages show it: control characters, line breaks, marks that turn the
/// direction of writing and bytes that are no UTF-8 become \n, \x1b, \u202e and the like. Does
/// nothing to what it returned before. `lines`: line breaks and tabs stay.
[[nodiscard]] std::string escaped(std::string_view text, bool lines = false);

/// An argument of a message: text escaped, anything else as it is.
template <class T>
decltype(auto) safe(const T& value) {
    if constexpr (std::is_convertible_v<const T&, std::string_view>)
        return escaped(value);
    else
        return (value);
}

/// Formats to standard output, text among the arguments escaped. Whether all of it could be written
/// says standard_output_fails().
template <class... Args>
void say(fmt::format_string<Args...> format, Args&&... args) {
    const std::string text =
        fmt::vformat(fmt::string_view(format), fmt::make_format_args(safe(args)...));
    std::fwrite(text.data(), 1, text.size(), stdout);
}

/// A line of warning to standard error, text among the arguments escaped.
template <class... Args>
void warn(fmt::format_string<Args...> format, Args&&... args) {
    const std::string text =
        "warning: " + fmt::vformat(fmt::string_view(format), fmt::make_format_args(safe(args)...)) +
        "\n";
    std::fwrite(text.data(), 1, text.size(), stderr);
}

/// Writes what is left for standard output. Whether that, or anything before, could not be written.
[[nodiscard]] bool standard_output_fails();

}  // namespace manylight

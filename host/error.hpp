// SPDX-License-Identifier: MIT
#pragma once

#include <fmt/format.h>

#include <stdexcept>
#include <string>

namespace manylight {

/// Something that the user gave is wrong: a file, an option, a value. The message names all three.
/// The program exits with 2.
struct InputError : std::runtime_error {
    template <class... Args>
    explicit InputError(fmt::format_string<Args...> format, Args&&... args)
        : std::runtime_error(fmt::format(format, std::forward<Args>(args)...)) {}
};

/// The machine could not do it: an OpenCL call, a full disk. The program exits with 1.
struct RuntimeError : std::runtime_error {
    template <class... Args>
    explicit RuntimeError(fmt::format_string<Args...> format, Args&&... args)
        : std::runtime_error(fmt::format(format, std::forward<Args>(args)...)) {}
};

}  // namespace manylight

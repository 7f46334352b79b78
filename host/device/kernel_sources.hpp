// SPDX-License-Identifier: MIT
#pragma once

#include <map>
#include <string>
#include <string_view>

namespace manylight {

/// Every file below kernels/, by its path from there; made by cmake/embed.cmake.
extern const std::map<std::string_view, std::string_view> kernel_sources;

/// The text of a kernel file with its includes in place, each file once, with #line markers so that
/// a compiler's messages cite the real file. (-I cannot be used: PoCL fails on paths with spaces.)
[[nodiscard]] std::string assemble_source(std::string_view path);

}  // namespace manylight

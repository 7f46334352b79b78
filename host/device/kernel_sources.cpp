// SPDX-License-Identifier: MIT
#include "device/kernel_sources.hpp"

#include <fmt/format.h>

#include <set>
#include <stdexcept>

namespace manylight {
namespace {

void append(std::string_view path, std::set<std::string, std::less<>>& done, std::string& out) {
    const auto source = kernel_sources.find(path);
    if (source == kernel_sources.end())
        throw std::logic_error(fmt::format("no kernel source named {}", path));
    // A file without a guard is to be included as often as it says.
    const bool guarded = source->second.find("#ifndef MANYLIGHT_") != std::string_view::npos;
    if (guarded && !done.emplace(path).second) return;
    constexpr std::string_view directive = "#include \"";
    out += fmt::format("#line 1 \"{}\"\n", path);
    std::string_view rest = source->second;
    for (int line = 1; !rest.empty(); ++line) {
        const std::size_t length = std::min(rest.find('\n'), rest.size() - 1) + 1;
        const std::string_view text = rest.substr(0, length);
        rest.remove_prefix(length);
        if (!text.starts_with(directive)) {
            out += text;
            continue;
        }
        const std::string_view name = text.substr(directive.size());
        append(name.substr(0, name.find('"')), done, out);
        out += fmt::format("#line {} \"{}\"\n", line + 1, path);
    }
}

}  // namespace

std::string assemble_source(std::string_view path) {
    std::set<std::string, std::less<>> done;
    std::string out;
    append(path, done, out);
    return out;
}

}  // namespace manylight

// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <filesystem>

#include "commands/commands.hpp"
#include "output/write_file.hpp"
#include "scene/builtin/builtin.hpp"

namespace manylight {

int run_scene(const BuiltinArguments& arguments) {
    const std::string ending = ".glb";
    check_output("--output", arguments.output, {&ending, 1});
    make_builtin(arguments.name, {arguments.lights, arguments.mesh}).write(arguments.output);
    fmt::print("wrote {} ({} KiB)\n", arguments.output,
               std::filesystem::file_size(arguments.output) >> 10);
    return 0;
}

}  // namespace manylight

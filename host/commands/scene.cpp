// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <filesystem>

#include "commands/commands.hpp"
#include "error.hpp"
#include "scene/builtin/builtin.hpp"

namespace manylight {

int run_scene(const BuiltinArguments& arguments) {
    if (!arguments.output.ends_with(".glb"))
        throw InputError("--output {}: the name must end in .glb", arguments.output);
    make_builtin(arguments.name, {arguments.lights, arguments.mesh}).write(arguments.output);
    fmt::print("wrote {} ({} KiB)\n", arguments.output,
               std::filesystem::file_size(arguments.output) >> 10);
    return 0;
}

}  // namespace manylight

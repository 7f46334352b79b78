// SPDX-License-Identifier: MIT
// The command line.
#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "commands/commands.hpp"
#include "commands/options/commands.hpp"
#include "commands/options/words.hpp"
#include "error.hpp"

namespace manylight {
namespace options {
namespace {

void add_help(CLI::App& app, std::function<int()>& run) {
    auto name = std::make_shared<std::string>();
    CLI::App* command =
        app.add_subcommand("help", "the same as --help, of a command if one is named");
    command->add_option("command", *name, "render, inspect, ...");
    command->callback([&app, &run, name] {
        if (!name->empty() && std::ranges::count(names_of_commands(app), *name) == 0)
            throw InputError("help: {}", unknown_command(app, *name));
        run = [name] {
            std::string words[] = {"manylight", "--help", *name};
            char* arguments[] = {words[0].data(), words[1].data(), words[2].data()};
            if (!name->empty()) std::swap(arguments[1], arguments[2]);
            return run_program(name->empty() ? 2 : 3, arguments);
        };
    });
}

}  // namespace
}  // namespace options

int run_program(int argc, char** argv) {
    CLI::App app(
        "manylight renders the direct light of hundreds to a million lights on any OpenCL device.",
        "manylight");
    app.set_version_flag("--version", "manylight " MANYLIGHT_VERSION);
    app.require_subcommand(0, 1);
    app.footer("\n'manylight COMMAND --help' tells more, with examples.\n");
    std::function<int()> run;
    options::add_render(app, run);
    options::add_inspect(app, run);
    options::add_verify(app, run);
    options::add_bench(app, run);
    options::add_scene_command(app, run);
    app.add_subcommand("devices", "list OpenCL devices and what each can do")->callback([&run] {
        run = run_devices;
    });
    CLI::App* samplers = app.add_subcommand("samplers", "list the samplers that there are");
    const auto as_json = std::make_shared<bool>(false);
    samplers->add_flag("--json", *as_json, "for programs");
    samplers->callback([&run, as_json] { run = [as_json] { return run_samplers(*as_json); }; });
    options::add_chart(app, run);
    options::add_compare(app, run);
    options::add_help(app, run);
    try {
        app.parse(argc, argv);
    } catch (const CLI::Success& help) {
        return app.exit(help);
    } catch (const CLI::ExtrasError&) {
        throw InputError("{}", options::unknown_words(app));
    } catch (const CLI::ParseError& error) {
        throw InputError("{}", error.what());
    }
    if (!run) throw InputError("no command is given; 'manylight --help' lists them");
    return run();
}

}  // namespace manylight

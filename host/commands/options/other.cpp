// SPDX-License-Identifier: MIT
// The options of all commands but render.
#include <fmt/format.h>

#include <memory>
#include <tuple>

#include "commands/options/commands.hpp"
#include "commands/options/scene.hpp"
#include "commands/options/values.hpp"
#include "commands/options/words.hpp"
#include "verify/sampler_checks.hpp"
#include "verify/stages.hpp"

namespace manylight::options {

void add_inspect(CLI::App& app, std::function<int()>& run) {
    auto arguments = std::make_shared<InspectArguments>();
    CLI::App* command = app.add_subcommand(
        "inspect", "tell why a pixel is noisy: what sampler adaptive knows there, and the truth");
    add_scene(*command, arguments->scene);
    InspectArguments& a = *arguments;
    a.options.light_samples = 4;
    command->add_option_function<std::string>(
        "--pixel", [&a](const std::string& text) { std::tie(a.x, a.y) = parse_pixel(text); },
        "X,Y: the pixel, from the top left");
    command->add_option("-o,--output", a.output,
                        "picture, .png (default: the scene's name with -pixel.png, here)");
    command->add_option("--json", a.json, "file for the same as JSON");
    command->add_option("--top-lights", a.top_lights, "lights, or groups of them, that are listed")
        ->check(whole(1, 320))
        ->capture_default_str();
    command
        ->add_option("--light-samples", a.options.light_samples, "light samples per pixel sample")
        ->check(whole(1, 65536))
        ->capture_default_str();
    command->add_option("--spp", a.options.spp, "pixel samples to learn from")
        ->check(whole(1, 1 << 20))
        ->capture_default_str();
    command->add_option("--seed", a.options.seed, "of the random numbers")
        ->check(whole(0, largest_uint))
        ->capture_default_str();
    command->add_option_function<std::string>(
        "--memory", [&a](const std::string& text) { a.options.memory = parse_bytes(text); },
        "most memory on the device, such as 512M (default: half of it, at most 2G)");
    command->footer(
        "\nRenders the image with sampler adaptive, then reports its state at the pixel's centre.\n"
        "\nExamples:\n"
        "  manylight inspect scene.glb --pixel 320,200\n"
        "  manylight inspect scene.glb --pixel 320,200 --top-lights 8 -o why.png --json "
        "why.json\n");
    command->callback([&run, arguments, command] {
        require_scene(*command, arguments->scene);
        require(*command, command->count("--pixel") > 0, "--pixel X,Y");
        run = [arguments] { return run_inspect(*arguments); };
    });
}

namespace {

std::vector<std::string> words_of_stages() {
    const std::vector<std::string_view> names = stage_names();
    return {names.begin(), names.end()};
}

// Lines of at most 80 characters.
std::string stage_list() {
    std::string text;
    std::size_t column = 2;
    for (const std::string& name : words_of_stages()) {
        const bool first = text.empty();
        const bool breaks = column + name.size() + 3 > 80;
        if (!first) text += breaks ? ",\n  " : ", ";
        column = breaks ? 2 + name.size() : column + name.size() + 2;
        text += name;
    }
    return text;
}

}  // namespace

void add_verify_options(CLI::App& command, VerifyArguments& arguments) {
    command
        .add_option("file", arguments.scene.file,
                    "glTF 2.0 scene, .gltf or .glb (default: scenes of the program's own that "
                    "together use every kernel)")
        ->check(not_empty());
    add_view(command, arguments.scene);
    command.add_option("--json", arguments.json,
                       "file for all that is found, as JSON; -: standard output, alone");
    command.add_option("--seed", arguments.seed, "of the random numbers")
        ->check(whole(0, largest_uint))
        ->capture_default_str();
    const auto add_list = [&](const char* name, std::vector<std::string>& names, const char* help) {
        command.add_option(name, names, help)->delimiter(',')->allow_extra_args(false);
    };
    Selection& only = arguments.only;
    add_list("--stage", only.stages, "judge these stages alone, see below");
    add_list("--sampler", only.samplers,
             "judge these samplers' stages alone, see 'manylight samplers'");
    add_list("--scene", only.scenes,
             "without a file: take these of the program's own scenes alone, as the table names "
             "them");
    add_clusters(command, arguments.clusters);
}

void add_verify(CLI::App& app, std::function<int()>& run) {
    auto arguments = std::make_shared<VerifyArguments>();
    CLI::App* command =
        app.add_subcommand("verify", "judge every kernel on a device by the scalar reference");
    add_verify_options(*command, *arguments);
    command->footer(
        "\nStages:\n  " + stage_list() +
        "\n\nExits with 0 if all stages pass, with 3 otherwise. Says that the device computes "
        "correctly only\nwhere no kernel and no feature was left out, which takes the program's "
        "own scenes.\n\nExamples:\n"
        "  manylight verify\n"
        "  manylight verify --device intel --json intel.json\n"
        "  manylight verify --device-form gpu --json - | jq .verdict\n"
        "  manylight verify --stage gbuffer,contributions --scene mirrors\n"
        "  manylight verify --sampler ris\n"
        "  manylight verify scene.glb\n"
        "  manylight verify scene.glb --device intel --width 128\n");
    command->callback([&run, arguments] {
        for (const std::string& stage : arguments->only.stages)
            require_word("--stage", stage, words_of_stages());
        for (const std::string& name : arguments->only.samplers) {
            const std::vector<std::string_view>& own = checks_of(find_sampler(name)).stages;
            if (!arguments->only.takes_one_of(own))
                throw InputError("--sampler {}: its stages are {}, of which --stage names none",
                                 name, fmt::join(own, ", "));
        }
        run = [arguments] { return run_verify(*arguments); };
    });
}

void add_bench(CLI::App& app, std::function<int()>& run) {
    auto arguments = std::make_shared<BenchArguments>();
    CLI::App* command =
        app.add_subcommand("bench", "measure traversal, beside Embree, and the stages of a frame");
    command->add_option("what", arguments->what, "traversal, stages, or a scene file for both");
    command->add_option("--mesh", arguments->mesh,
                        "traversal, stages: glTF file whose mesh stands in the dragon's room");
    add_choice<std::string>(*command, "--view", arguments->view,
                            {{"close", "close"}, {"far", "far"}},
                            "traversal, stages: far (the default) or close");
    command->add_flag("--loading", arguments->loading, "of a file: how fast it loads, instead");
    command->add_option("--json", arguments->json, "file for all figures");
    command->add_option("--rounds", arguments->rounds, "rounds in which all take turns")
        ->check(whole(1, 1000))
        ->capture_default_str();
    command->add_option("--sampler", arguments->sampler, "of the stages")->capture_default_str();
    command->add_option("--light-samples", arguments->light_samples, "of the stages")
        ->check(whole(1, 65536))
        ->capture_default_str();
    for (const auto& [name, value] : {std::pair{"--bvh-width", &arguments->bvh_width},
                                      std::pair{"--bvh-block", &arguments->bvh_block}})
        add_choice<unsigned>(*command, name, *value, {{"4", 4}, {"8", 8}, {"16", 16}},
                             "4, 8 or 16 (default: as suits the device)");
    add_view(*command, arguments->scene);
    command->footer(
        "\nA figure is printed only after its hits, or its stages, were judged by the scalar "
        "reference.\n\nExamples:\n"
        "  manylight bench traversal --view close\n"
        "  manylight bench traversal --mesh dragon.glb --json traversal.json\n"
        "  manylight bench scene.glb --device intel\n"
        "  manylight bench large.glb --loading\n");
    command->callback([&run, arguments, command] {
        require(*command, !arguments->what.empty(),
                "what to measure (traversal, stages or a file)");
        (void)find_sampler(arguments->sampler);
        run = [arguments] { return run_bench(*arguments); };
    });
}

void add_scene_command(CLI::App& app, std::function<int()>& run) {
    auto arguments = std::make_shared<BuiltinArguments>();
    CLI::App* command = app.add_subcommand("scene", "write a built-in scene as a .glb file");
    command->add_option("name", arguments->name, "see below");
    command->add_option("-o,--output", arguments->output, "file to write, .glb");
    command->add_flag("--list", arguments->list,
                      "print all scenes with their numbers as JSON, and write none");
    std::string footer = "\nScenes:\n";
    for (const Builtin& scene : all_builtins())
        footer += fmt::format("  {:<12}{}\n", scene.name, scene.summary);
    for (const Builtin& scene : all_builtins())
        for (const SceneParameter& p : scene.parameters)
            command->add_option_function<double>(
                fmt::format("--{}", p.name),
                [arguments, name = std::string(p.name)](double value) {
                    arguments->options.values[name] = value;
                },
                fmt::format("{}: {}, {:.6g} to {:.6g} (default: {:.6g})", scene.name, p.summary,
                            p.least(), p.most(), p.usual));
    command->add_option("--mesh", arguments->options.mesh,
                        "dragon: glTF file whose mesh stands in the room");
    command->footer(footer +
                    "\nExamples:\n"
                    "  manylight scene cornell -o cornell.glb\n"
                    "  manylight scene city --lights 1000000 -o city.glb\n"
                    "  manylight scene dragon --mesh bunny.glb -o bunny-room.glb\n");
    command->callback([&run, arguments, command] {
        require(*command, arguments->list || !arguments->name.empty(), "the scene's name");
        require(*command, arguments->list || !arguments->output.empty(), "--output FILE.glb");
        run = [arguments] { return run_scene(*arguments); };
    });
}

void add_chart(CLI::App& app, std::function<int()>& run) {
    auto arguments = std::make_shared<ChartArguments>();
    CLI::App* command = app.add_subcommand(
        "chart",
        "chart speed and accuracy of samplers on a scene, in a report to open in a browser");
    add_scene(*command, arguments->scene, 256);
    ChartOptions& o = arguments->options;
    command->add_option("-o,--output", arguments->output,
                        "folder (default: the scene's name with -chart, here)");
    const auto add_list = [&](const char* name, auto& values, const char* help) {
        return command->add_option(name, values, help)->delimiter(',')->allow_extra_args(false);
    };
    add_list("--samplers", o.samplers, "see below (default: all)");
    add_list("--light-samples", o.light_samples, "light samples per pixel sample")
        ->check(whole(1, 65536))
        ->default_str("1,4,16,64");
    const auto* spp = add_list("--spp", o.spp,
                               "pixel samples, all at the pixel's centre; with --whole anywhere in "
                               "it (default: 4,16)")
                          ->check(whole(1, most_spp))
                          ->default_str("1,4");
    command->add_flag("--whole", o.whole,
                      "judge what people see: anti-aliased pixels with the emitters in view, and "
                      "the time of the whole process (default: pixels' centres, emitters black)");
    command->add_option("--seeds", o.seeds, "how often each setting is rendered")
        ->check(whole(1, 1000))
        ->capture_default_str();
    command->add_option("--seed", o.seed, "the first seed")
        ->check(whole(0, 2'000'000'000))
        ->capture_default_str();
    command->add_option("--baseline", o.baseline,
                        "sampler that others are compared with (default: adaptive)");
    command
        ->add_option(
            "--most-seconds", o.most_seconds,
            "for all seeds of a setting: it has fewer where they would take longer, and is "
            "left out where one would")
        ->check(number(0.001, 1e9))
        ->capture_default_str();
    command
        ->add_option("--reference-time", o.reference_seconds,
                     "seconds to spend on the reference (default: until its own error is 100 times "
                     "below the smallest that it judges)")
        ->check(number(0.001, 1e9));
    command->add_option("--cache", o.cache,
                        "folder of references (default: manylight/references in XDG_CACHE_HOME)");
    command->add_option_function<std::string>(
        "--memory",
        [a = arguments.get()](const std::string& text) { a->memory = parse_bytes(text); },
        "most memory on the device, such as 512M (default: half of it, at most 2G)");
    command->add_flag("-q,--quiet", o.quiet, "print errors and warnings only");
    command->footer(sampler_list(false) +
                    "\nWrites report.html, chart.json, reference.exr and pictures of errors. An "
                    "interrupted reference goes on where it was.\n\nExamples:\n"
                    "  manylight chart scene.glb\n"
                    "  manylight chart scene.glb --samplers lighttree,adaptive --seeds 10 -o "
                    "two-samplers\n"
                    "  manylight chart scene.glb --light-samples 4 --spp 1,4,16 --height 512\n"
                    "  manylight chart scene.glb --whole --samplers lighttree,adaptive\n");
    command->callback([&run, arguments, command, spp] {
        require_scene(*command, arguments->scene);
        if (arguments->options.whole && spp->empty()) arguments->options.spp = {4, 16};
        for (const std::string& name : arguments->options.samplers)
            (void)find_sampler(name, "--samplers");
        run = [arguments] { return run_chart(*arguments); };
    });
}

void add_compare(CLI::App& app, std::function<int()>& run) {
    auto arguments = std::make_shared<CompareArguments>();
    CLI::App* command =
        app.add_subcommand("compare", "measure the errors of images against what they should be");
    command->add_option("images", arguments->images,
                        "images to judge, and last what they should be, unless --ref names it");
    command->add_option("--ref", arguments->reference, "what all images should be");
    command->add_option("-o,--output", arguments->output, "picture of the errors, .png");
    command->add_flag("--json", arguments->json, "print JSON");
    command->footer(
        "\nReads R, G, B of any image, also another renderer's: floats as linear values, integers "
        "as sRGB codes.\nExits with 3 where an image to judge holds what is no finite "
        "number.\n\nExamples:\n"
        "  manylight compare render.exr reference.exr\n"
        "  manylight compare a.exr b.exr c.exr reference.exr\n"
        "  manylight compare a.exr b.exr --ref reference.exr -o errors.png\n");
    command->callback([&run, arguments, command] {
        require(*command, !arguments->images.empty(), "the image to judge");
        if (arguments->reference.empty()) {
            require(*command, arguments->images.size() > 1, "the image that it should be");
            arguments->reference = arguments->images.back();
            arguments->images.pop_back();
        }
        run = [arguments] { return run_compare(*arguments); };
    });
}

}  // namespace manylight::options

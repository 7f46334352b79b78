// SPDX-License-Identifier: MIT
// The options of render.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <sstream>

#include "commands/options/commands.hpp"
#include "commands/options/scene.hpp"
#include "commands/options/values.hpp"
#include "commands/options/words.hpp"
#include "commands/repeat.hpp"
#include "error.hpp"
#include "output/image.hpp"
#include "pipeline/aov.hpp"
#include "print.hpp"

namespace manylight::options {
namespace {

// Pixel samples that an image has, from its header; more where the last was not taken everywhere.
std::string whole_spp(const std::string& spp) {
    return fmt::format("{:.0f}", std::max(std::ceil(std::strtod(spp.c_str(), nullptr)), 1.0));
}

// Gives the parameters of its sampler that an image's header tells, and the command line does not,
// their values.
void repeat_parameters(std::map<std::string, std::string>& facts, const std::string& sampler,
                       RenderArguments& a) {
    const auto set = facts.find("set");
    if (set == facts.end()) return;
    if (sampler == facts["sampler"]) {
        std::istringstream texts(set->second);
        for (std::string text; std::getline(texts, text, ',');)
            a.options.parameters.insert(parse_parameter(text));
    }
    facts.erase(set);
}

// Gives all options that an image's header tells, and the command line does not, their values.
void repeat(CLI::App& command, RenderArguments& a) {
    const std::string& image = a.like;
    std::map<std::string, std::string> facts = read_facts(image);
    if (!facts.contains("file") || !facts.contains("sampler"))
        throw InputError("--like {}: its header tells of no render of manylight's", image);
    if (facts["version"] != MANYLIGHT_VERSION)
        warn("--like {}: was rendered by manylight {}, this is {}: the image may differ", image,
             facts["version"], MANYLIGHT_VERSION);
    const bool stops_otherwise =
        command.count("--spp") + command.count("--time") + command.count("--target-error") > 0;
    if (stops_otherwise)
        facts.erase("spp");
    else if (facts["cut_short"] == "true")
        warn("--like {}: was cut short at {} spp; {} are rendered", image, facts["spp"],
             whole_spp(facts["spp"]));
    repeat_parameters(facts, command.count("--sampler") > 0 ? a.sampler : facts["sampler"], a);
    if (facts.contains("spp")) facts["spp"] = whole_spp(facts["spp"]);
    for (CLI::Option* option : command.get_options()) {
        const std::string name =
            option->get_lnames().empty() ? option->get_name(true) : option->get_lnames().front();
        const auto fact = facts.find(field_of(name));
        if (fact == facts.end() || option->count() > 0) continue;
        const bool is_flag = option->get_expected_min() == 0;
        if (is_flag && fact->second == "false") continue;
        try {
            option->add_result(is_flag ? option->get_flag_value(name, "") : fact->second);
            option->run_callback();
        } catch (const CLI::ParseError& error) {
            throw InputError("--like {}: {}", image, error.what());
        }
    }
}

// Where the image goes, how it is sampled and when that ends.
void add_sampling(CLI::App& command, RenderArguments& a) {
    RenderOptions& o = a.options;
    command
        .add_option("-o,--output", a.outputs,
                    "image, .exr or .png; may be given several times (default: the scene's "
                    "name with .png, here)")
        ->allow_extra_args(false);
    command.add_option("--sampler", a.sampler, "see below")->capture_default_str();
    command
        .add_option_function<std::vector<std::string>>(
            "--set",
            [&o](const std::vector<std::string>& texts) {
                for (const std::string& text : texts) {
                    const auto [name, value] = parse_parameter(text);
                    if (!o.parameters.emplace(name, value).second)
                        throw CLI::ValidationError("--set", name + " is given twice");
                }
            },
            "NAME=VALUE: parameters of the sampler, see below")
        ->delimiter(',')
        ->allow_extra_args(false);
    command
        .add_option("--light-samples", o.light_samples,
                    "light samples per pixel sample (default: 4 in the first four, then 16)")
        ->check(whole(1, 65536));
    command
        .add_option("--spp", a.spp,
                    "pixel samples, at most; 1: at the pixel's centre (default: 4, or what --time "
                    "and --target-error allow)")
        ->check(whole(1, most_spp));
    command
        .add_option("--time", a.seconds,
                    "seconds to render in, all work from start to written files counted")
        ->check(number(0.001, 1e9));
    command
        .add_option(
            "--target-error", o.target_error,
            "render until the estimated relMSE, with its margin of error, is no more than this")
        ->check(number(1e-12, 1e12));
    command.add_option("--seed", o.seed, "same seed, same image")
        ->check(whole(0, largest_uint))
        ->capture_default_str();
}

// What the image shows.
void add_look(CLI::App& command, RenderArguments& a) {
    RenderOptions& o = a.options;
    command.add_flag("--pixel-centre", o.pixel_centre, "all pixel samples at the pixel's centre");
    command.add_flag("--hide-emitters", o.hide_emitters,
                     "show emissive surfaces black: what is left is what they light");
    command.add_flag("!--no-reflections", o.reflections,
                     "glossy reflections of area lights by light samples alone, for comparison");
    command
        .add_option("--exposure", a.exposure,
                    "stops by which a .png is brighter than the scene (default: automatic)")
        ->check(number(-100, 100));
    command.add_option("--aov", o.aovs, "extra layers of the .exr, see below")
        ->delimiter(',')
        ->allow_extra_args(false);
}

// What else is made, and how the render goes on after a break, or again.
void add_outputs(CLI::App& command, RenderArguments& a) {
    command.add_option("--cluster-map", a.cluster_map,
                       "picture of the clusters and their representatives, .png");
    command
        .add_option("--top-lights", a.top_lights,
                    "list the K lights that give the image most, with their shares")
        ->check(whole(1, 1000));
    command.add_option("--stats", a.stats, "seconds, rays and memory, as JSON");
    command.add_option("--checkpoint", a.checkpoint,
                       "file to save the render's state to every minute, and at its end");
    command.add_option("--checkpoint-every", a.checkpoint_seconds, "seconds between two times")
        ->check(number(0, 1e9))
        ->capture_default_str();
    command
        .add_flag("--resume", a.resume,
                  "go on from the --checkpoint, if there is one: the image is that of a render "
                  "without a break, bit for bit; with more --spp, it gets these")
        ->needs("--checkpoint");
    command.add_option_function<std::string>(
        "--memory", [&a](const std::string& text) { a.options.memory = parse_bytes(text); },
        "most memory on the device, such as 512M (default: half of it, at most 2G)");
    command.add_flag("-q,--quiet", a.quiet, "print errors and warnings only");
    command
        .add_option("--like", a.like,
                    "repeat the render that made this image, by its header; options that are "
                    "given here count instead")
        ->check(not_empty());
}

// Once all is parsed: what the image to repeat tells, what is missing or wrong, and the default of
// --spp.
void complete(CLI::App& command, RenderArguments& a) {
    a.repeats_aovs = command.count("--aov") == 0;
    if (!a.like.empty()) repeat(command, a);
    require_scene(command, a.scene);
    if (a.sampler != "auto") (void)find_sampler(a.sampler);
    RenderOptions& o = a.options;
    const bool open_ended = a.seconds > 0 || o.target_error > 0;
    o.spp = a.spp.value_or(open_ended ? most_spp : o.spp);
    for (const std::string& name : a.options.aovs)
        if (std::ranges::none_of(all_aovs(), [&](const Aov& aov) { return aov.name == name; }))
            throw CLI::ValidationError("--aov", "there is no layer " + name);
}

}  // namespace

void add_render(CLI::App& app, std::function<int()>& run) {
    auto arguments = std::make_shared<RenderArguments>();
    CLI::App* command = app.add_subcommand("render", "render a scene to an image");
    add_scene(*command, arguments->scene);
    add_sampling(*command, *arguments);
    add_look(*command, *arguments);
    add_outputs(*command, *arguments);
    add_clusters(*command, arguments->options.clusters);
    command->footer(sampler_list(true) + aov_list() +
                    "\nExamples:\n"
                    "  manylight render scene.glb\n"
                    "  manylight render scene.glb -o a.exr -o a.png --spp 16 --light-samples 8\n"
                    "  manylight render scene.glb --time 10\n"
                    "  manylight render scene.glb --target-error 0.001 --aov error -o a.exr\n"
                    "  manylight render scene.glb --sampler exhaustive -o reference.exr\n"
                    "  manylight render scene.glb --cluster-map clusters.png --stats stats.json\n"
                    "  manylight render scene.glb --top-lights 10\n"
                    "  manylight render --like a.exr -o again.exr\n"
                    "  manylight render scene.glb --spp 4096 --checkpoint state --resume\n");
    command->callback([&run, arguments, command] {
        complete(*command, *arguments);
        run = [arguments] { return run_render(*arguments); };
    });
}

}  // namespace manylight::options

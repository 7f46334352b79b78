// SPDX-License-Identifier: MIT
// The command line; CLI11 is included here only (it takes long to compile).
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>

#include "commands/commands.hpp"
#include "commands/repeat.hpp"
#include "error.hpp"
#include "output/image.hpp"
#include "pipeline/aov.hpp"
#include "print.hpp"

namespace manylight {
namespace {

// "2G", "512M", "100000": bytes.
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

// "3,-1.5": a shift by pixels.
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

// A whole number within limits; CLI11's own range prints limits of 300 digits.
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

const CLI::Validator not_empty(
    [](std::string& file) { return std::string(file.empty() ? "the name is empty" : ""); }, "");

const CLI::Validator power_of_two(
    [](std::string& text) {
        for (const char* allowed : {"8", "16", "32", "64", "128"})
            if (text == allowed) return std::string();
        return text + " is not 8, 16, 32, 64 or 128";
    },
    "");

constexpr std::uint64_t largest_uint = 4294967295;
constexpr uint most_spp = 1 << 20;

const std::map<std::string, MeshStorage> mesh_storages = {{"auto", MeshStorage::automatic},
                                                          {"copied", MeshStorage::copied},
                                                          {"shared", MeshStorage::shared}};

const std::map<std::string, Headlight> headlights = {
    {"never", Headlight::never}, {"auto", Headlight::automatic}, {"always", Headlight::always}};

const std::map<std::string, unsigned> device_forms = {
    {"auto", 0}, {"gpu", 1}, {"4", 4}, {"8", 8}, {"16", 16}};

// "a, b or c".
std::string list_words(const std::vector<std::string>& words) {
    std::string out;
    for (std::size_t i = 0; i < words.size(); ++i)
        out += (i == 0 ? "" : i + 1 < words.size() ? ", " : " or ") + words[i];
    return out;
}

// An option whose value is one of a few words. (CLI11's own transformer tells users of its maps.)
template <class T>
void add_choice(CLI::App& command, const std::string& name, T& value,
                const std::map<std::string, T>& choices, const std::string& help) {
    command.add_option_function<std::string>(
        name,
        [name, &value, choices](const std::string& text) {
            std::vector<std::string> words;
            for (const auto& [word, meaning] : choices) words.push_back(word);
            if (!choices.contains(text))
                throw CLI::ValidationError(name, text + " is not " + list_words(words));
            value = choices.at(text);
        },
        help);
}

// How many characters to insert, delete, replace or swap with the next take one word to another.
// Source: the optimal string alignment distance (Damerau 1964, Levenshtein 1966).
std::size_t edit_distance(const std::string& a, const std::string& b) {
    std::vector<std::vector<std::size_t>> d(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
    for (std::size_t i = 0; i <= a.size(); ++i)
        for (std::size_t j = 0; j <= b.size(); ++j) {
            if (i == 0 || j == 0) {
                d[i][j] = i + j;
                continue;
            }
            d[i][j] = std::min({d[i - 1][j] + 1, d[i][j - 1] + 1,
                                d[i - 1][j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1)});
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
                d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 1);
        }
    return d[a.size()][b.size()];
}

// "; did you mean X?" where one of the words is near, or begins so; else nothing.
std::string suggestion(const std::string& word, const std::vector<std::string>& words) {
    const std::string* best = nullptr;
    std::size_t least = std::max<std::size_t>(word.size() / 3, 1) + 1;
    for (const std::string& w : words) {
        const bool begins = word.size() >= 3 && w.starts_with(word);
        const std::size_t distance = begins ? 1 : edit_distance(word, w);
        if (distance >= least) continue;
        least = distance;
        best = &w;
    }
    return best == nullptr ? "" : "; did you mean " + *best + "?";
}

std::vector<std::string> names_of_commands(const CLI::App& app) {
    std::vector<std::string> names;
    for (const CLI::App* command : app.get_subcommands({})) names.push_back(command->get_name());
    return names;
}

std::string unknown_command(const CLI::App& app, const std::string& word) {
    if (word.ends_with(".gltf") || word.ends_with(".glb"))
        return fmt::format("{}: is no command; 'manylight render {}' renders it", word, word);
    return fmt::format("{}: is no command{}", word, suggestion(word, names_of_commands(app)));
}

// What is wrong with words that no option takes.
std::string unknown_words(const CLI::App& app) {
    const std::vector<std::string> words = app.remaining(true);
    if (app.get_subcommands().empty()) {
        const auto first = std::ranges::find_if(words, [](auto& w) { return !w.starts_with("-"); });
        if (first != words.end()) return unknown_command(app, *first);
    }
    const CLI::App& command = app.get_subcommands().empty() ? app : *app.get_subcommands().front();
    const std::string& word = words.front();
    if (!word.starts_with("-"))
        return fmt::format("{}: {}: is one argument too many", command.get_name(), word);
    std::vector<std::string> options;
    for (const CLI::Option* option : command.get_options())
        for (const std::string& name : option->get_lnames()) options.push_back("--" + name);
    const std::string name = word.substr(0, word.find('='));
    const std::string known = suggestion(name, options);
    return fmt::format("{}: {}: there is no such option{}", command.get_name(), name, known);
}

// What a command that renders a scene needs beside its file.
void add_view(CLI::App& command, SceneArguments& scene, unsigned height = 512) {
    command.add_option("--camera", scene.camera, "camera by name (default: the file's first)");
    command
        .add_option("--emitter-points", scene.emitter_points,
                    "replace emissive triangles by N oriented points of equal power; 0: area "
                    "lights (default: the file's wish, or 0)")
        ->check(whole(0, 1 << 24));
    command.add_option("--at", scene.seconds,
                       "SECONDS of the file's first animation (default: everything at rest)");
    command
        .add_option("--lamp-scale", scene.lamp_scale,
                    "multiply what point, spot and directional lights emit; 0.00146413 takes back "
                    "the 683 lm/W of Blender's export, which emissive surfaces do not get")
        ->check(number(1e-12, 1e12));
    add_choice(command, "--headlight", scene.headlight, headlights,
               "a light at the camera: never, always or auto (where nothing in the file gives "
               "light or shows without)");
    command.add_flag("--cull-back-faces", scene.cull_back_faces,
                     "no ray meets the back of what is not doubleSided, as in viewers of glTF "
                     "(default: all is seen from both sides, as in Blender)");
    command.add_option("--variant", scene.variant,
                       "materials of that variant of the file's (KHR_materials_variants)");
    add_choice(command, "--instances", scene.storage, mesh_storages,
               "meshes that stand in several places: shared (stored once), copied (faster to "
               "trace) or auto (shared where copies would take more than 256 MiB)");
    command.add_option("--device", scene.device,
                       "OpenCL device: number or part of its name, see 'manylight devices'");
    add_choice(command, "--device-form", scene.lanes, device_forms,
               "how kernels are laid out: auto (as suits the device), in vectors of 4, 8 or 16 "
               "lanes, or gpu (what GPUs run, on any device)");
    command.add_option("--threads", scene.threads, "processors that a CPU device may use")
        ->check(whole(1, 4096));
    command.add_option("--width", scene.width, "image width (default: from the height)")
        ->check(whole(1, 65536));
    command.add_option("--height", scene.height, fmt::format("image height (default: {})", height))
        ->check(whole(1, 65536));
    command.add_option_function<std::string>(
        "--shift", [&scene](const std::string& text) { scene.shift = parse_shift(text); },
        "X,Y: show what is so many pixels farther right and down, as a shifted lens does");
}

void add_scene(CLI::App& command, SceneArguments& scene, unsigned height = 512) {
    command.add_option("file", scene.file, "glTF 2.0 scene, .gltf or .glb")->check(not_empty);
    add_view(command, scene, height);
}

void add_clusters(CLI::App& command, ClusterOptions& clusters) {
    const char* group = "Clusters (samplers contribution and contribution-defensive)";
    command.add_option("--tile-size", clusters.tile_size, "pixels of a tile's side")
        ->check(power_of_two)
        ->capture_default_str()
        ->group(group);
    command.add_option("--max-depth", clusters.max_depth, "depth of a tile's quadtree")
        ->check(whole(0, 7))
        ->capture_default_str()
        ->group(group);
    command
        .add_option("--normal-threshold", clusters.normal_threshold,
                    "split where corner normals differ by more degrees")
        ->check(number(0, 180))
        ->capture_default_str()
        ->group(group);
    command
        .add_option("--visibility-threshold", clusters.shadow.threshold,
                    "split where less than this share of the lights is seen")
        ->check(number(0, 1))
        ->capture_default_str()
        ->group(group);
}

std::string sampler_list(bool automatic) {
    std::string text = "\nSamplers:\n";
    if (automatic)
        text +=
            fmt::format("  {:<24}{}\n", "auto",
                        "exhaustive where lights are no more than light samples, else adaptive");
    for (const Sampler& s : all_samplers())
        text +=
            fmt::format("  {:<24}{} ({})\n", s.name, s.summary, s.biased ? "biased" : "unbiased");
    return text;
}

std::string aov_list() {
    std::string text = "\nLayers for --aov:\n";
    for (const Aov& aov : all_aovs()) text += fmt::format("  {:<24}{}\n", aov.name, aov.summary);
    return text;
}

// Throws for a missing argument: `what` it is.
void require(const CLI::App& command, bool is_there, const std::string& what) {
    if (is_there) return;
    throw InputError("{}: {} is missing; 'manylight {} --help' shows examples", command.get_name(),
                     what, command.get_name());
}

void require_scene(const CLI::App& command, const SceneArguments& scene) {
    require(command, !scene.file.empty(), "the scene's file");
}

// Pixel samples that an image has, from its header; more where the last was not taken everywhere.
std::string whole_spp(const std::string& spp) {
    return fmt::format("{:.0f}", std::max(std::ceil(std::strtod(spp.c_str(), nullptr)), 1.0));
}

// Gives all options that an image's header tells, and the command line does not, their values.
void repeat(CLI::App& command, const std::string& image) {
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

void add_render(CLI::App& app, std::function<int()>& run) {
    auto arguments = std::make_shared<RenderArguments>();
    CLI::App* command = app.add_subcommand("render", "render a scene to an image");
    add_scene(*command, arguments->scene);
    RenderOptions& o = arguments->options;
    command
        ->add_option("-o,--output", arguments->outputs,
                     "image, .exr or .png; may be given several times (default: the scene's "
                     "name with .png, here)")
        ->allow_extra_args(false);
    command->add_option("--sampler", arguments->sampler, "see below")->capture_default_str();
    command
        ->add_option("--light-samples", o.light_samples,
                     "light samples per pixel sample (default: 4 in the first four, then 16)")
        ->check(whole(1, 65536));
    command
        ->add_option("--spp", arguments->spp,
                     "pixel samples, at most; 1: at the pixel's centre (default: 4, or what --time "
                     "and --target-error allow)")
        ->check(whole(1, most_spp));
    command
        ->add_option("--time", arguments->seconds,
                     "seconds to render in, all work from start to written files counted")
        ->check(number(0.001, 1e9));
    command
        ->add_option(
            "--target-error", o.target_error,
            "render until the estimated relMSE, with its margin of error, is no more than this")
        ->check(number(1e-12, 1e12));
    command->add_option("--seed", o.seed, "same seed, same image")
        ->check(whole(0, largest_uint))
        ->capture_default_str();
    command->add_flag("--pixel-centre", o.pixel_centre, "all pixel samples at the pixel's centre");
    command->add_flag("--hide-emitters", o.hide_emitters,
                      "show emissive surfaces black: what is left is what they light");
    command->add_flag("!--no-reflections", o.reflections,
                      "glossy reflections of area lights by light samples alone, for comparison");
    command
        ->add_option("--exposure", arguments->exposure,
                     "stops by which a .png is brighter than the scene (default: automatic)")
        ->check(number(-100, 100));
    command->add_option("--aov", o.aovs, "extra layers of the .exr, see below")
        ->delimiter(',')
        ->allow_extra_args(false);
    command->add_option("--cluster-map", arguments->cluster_map,
                        "picture of the clusters and their representatives, .png");
    command
        ->add_option("--top-lights", arguments->top_lights,
                     "list the K lights that give the image most, with their shares")
        ->check(whole(1, 1000));
    command->add_option("--stats", arguments->stats, "seconds, rays and memory, as JSON");
    command->add_option("--checkpoint", arguments->checkpoint,
                        "file to save the render's state to every minute, and at its end");
    command
        ->add_option("--checkpoint-every", arguments->checkpoint_seconds,
                     "seconds between two times")
        ->check(number(0, 1e9))
        ->capture_default_str();
    command
        ->add_flag("--resume", arguments->resume,
                   "go on from the --checkpoint, if there is one: the image is that of a render "
                   "without a break, bit for bit; with more --spp, it gets these")
        ->needs("--checkpoint");
    command->add_option_function<std::string>(
        "--memory", [&o](const std::string& text) { o.memory = parse_bytes(text); },
        "most memory on the device, such as 512M (default: half of it, at most 2G)");
    command->add_flag("-q,--quiet", arguments->quiet, "print errors and warnings only");
    command
        ->add_option("--like", arguments->like,
                     "repeat the render that made this image, by its header; options that are "
                     "given here count instead")
        ->check(not_empty);
    add_clusters(*command, o.clusters);
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
        arguments->repeats_aovs = command->count("--aov") == 0;
        if (!arguments->like.empty()) repeat(*command, arguments->like);
        require_scene(*command, arguments->scene);
        if (arguments->sampler != "auto") (void)find_sampler(arguments->sampler);
        RenderOptions& o = arguments->options;
        const bool open_ended = arguments->seconds > 0 || o.target_error > 0;
        o.spp = arguments->spp.value_or(open_ended ? most_spp : o.spp);
        for (const std::string& name : arguments->options.aovs)
            if (std::ranges::none_of(all_aovs(), [&](const Aov& a) { return a.name == name; }))
                throw CLI::ValidationError("--aov", "there is no layer " + name);
        run = [arguments] { return run_render(*arguments); };
    });
}

// "320,200": a pixel.
void parse_pixel(const std::string& text, InspectArguments& out) {
    const std::size_t comma = text.find(',');
    std::string x = text.substr(0, comma);
    std::string y = comma == std::string::npos ? "" : text.substr(comma + 1);
    const CLI::Validator coordinate = whole(0, 65535);
    if (!coordinate(x).empty() || !coordinate(y).empty())
        throw CLI::ValidationError("--pixel", text + " is no pixel; write, for instance, 320,200");
    out.x = static_cast<unsigned>(std::stoul(x));
    out.y = static_cast<unsigned>(std::stoul(y));
}

void add_inspect(CLI::App& app, std::function<int()>& run) {
    auto arguments = std::make_shared<InspectArguments>();
    CLI::App* command = app.add_subcommand(
        "inspect", "tell why a pixel is noisy: what sampler adaptive knows there, and the truth");
    add_scene(*command, arguments->scene);
    InspectArguments& a = *arguments;
    a.options.light_samples = 4;
    command->add_option_function<std::string>(
        "--pixel", [&a](const std::string& text) { parse_pixel(text, a); },
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

void add_verify(CLI::App& app, std::function<int()>& run) {
    auto arguments = std::make_shared<VerifyArguments>();
    CLI::App* command =
        app.add_subcommand("verify", "judge every kernel on a device by the scalar reference");
    command
        ->add_option("file", arguments->scene.file,
                     "glTF 2.0 scene, .gltf or .glb (default: scenes of the program's own that "
                     "together use every kernel)")
        ->check(not_empty);
    add_view(*command, arguments->scene);
    command->add_option("--json", arguments->json,
                        "file for all that is found, as JSON; -: standard output, alone");
    command->add_option("--seed", arguments->seed, "of the random numbers")
        ->check(whole(0, largest_uint))
        ->capture_default_str();
    add_clusters(*command, arguments->clusters);
    command->footer(
        "\nExits with 0 if all stages pass, with 3 otherwise. Says that the device computes "
        "correctly only\nwhere no kernel and no feature was left out, which takes the program's "
        "own scenes.\n\nExamples:\n"
        "  manylight verify\n"
        "  manylight verify --device intel --json intel.json\n"
        "  manylight verify --device-form gpu --json - | jq .verdict\n"
        "  manylight verify scene.glb\n"
        "  manylight verify scene.glb --device intel --width 128\n");
    command->callback([&run, arguments] { run = [arguments] { return run_verify(*arguments); }; });
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
        for (const Parameter& p : scene.parameters)
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
    add_list("--spp", o.spp, "pixel samples, all at the pixel's centre")
        ->check(whole(1, most_spp))
        ->default_str("1,4");
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
                    "  manylight chart scene.glb --light-samples 4 --spp 1,4,16 --height 512\n");
    command->callback([&run, arguments, command] {
        require_scene(*command, arguments->scene);
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

int run_program(int argc, char** argv) {
    CLI::App app(
        "manylight renders the direct light of hundreds to a million lights on any OpenCL device.",
        "manylight");
    app.set_version_flag("--version", "manylight " MANYLIGHT_VERSION);
    app.require_subcommand(0, 1);
    app.footer("\n'manylight COMMAND --help' tells more, with examples.\n");
    std::function<int()> run;
    add_render(app, run);
    add_inspect(app, run);
    add_verify(app, run);
    add_bench(app, run);
    add_scene_command(app, run);
    app.add_subcommand("devices", "list OpenCL devices and what each can do")->callback([&run] {
        run = run_devices;
    });
    add_chart(app, run);
    add_compare(app, run);
    add_help(app, run);
    try {
        app.parse(argc, argv);
    } catch (const CLI::Success& help) {
        return app.exit(help);
    } catch (const CLI::ExtrasError&) {
        throw InputError("{}", unknown_words(app));
    } catch (const CLI::ParseError& error) {
        throw InputError("{}", error.what());
    }
    if (!run) throw InputError("no command is given; 'manylight --help' lists them");
    return run();
}

}  // namespace manylight

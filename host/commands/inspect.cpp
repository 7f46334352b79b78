// SPDX-License-Identifier: MIT
#include "pipeline/inspect.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "commands/commands.hpp"
#include "commands/describe.hpp"
#include "error.hpp"
#include "output/pixel_picture.hpp"
#include "output/write_file.hpp"
#include "pipeline/frame.hpp"
#include "print.hpp"
#include "reference/shading.hpp"

namespace manylight {
namespace {

using nlohmann::json;

constexpr double believed_hidden = 0.25;  // V^ below

// A report with what it is about.
struct Inspected {
    const LoadedScene& loaded;
    const LightTree& tree;
    const PixelReport& report;
    std::vector<InspectedNode> ranked;  // by share of the light, the draws or the noise
    double luminance;                   // of all lights, cd/m2
    double draws;
    uint spp;
    glm::vec3 rendered;  // cd/m2
    glm::vec3 emitted;   // by the surface itself, cd/m2

    [[nodiscard]] double light_share(const InspectedNode& n) const {
        return luminance > 0 ? n.contribution / luminance : 0;
    }
    [[nodiscard]] double draw_share(const InspectedNode& n) const {
        return draws > 0 ? n.draws / draws : 0;
    }
    // Standard deviation of the luminance of a pixel sample over the luminance.
    [[nodiscard]] double deviation() const {
        return luminance > 0 ? std::sqrt(report.variance) / luminance : 0;
    }
    [[nodiscard]] const LightNode& node(const InspectedNode& n) const { return tree.nodes[n.node]; }
    [[nodiscard]] std::size_t light(const InspectedNode& n) const {
        return tree.order[node(n).first];
    }
    [[nodiscard]] std::string name(const InspectedNode& n) const {
        return node(n).count == 1 ? name_of(loaded.scene, light(n))
                                  : fmt::format("{} lights", node(n).count);
    }
    [[nodiscard]] std::string place(const InspectedNode& n) const {
        if (node(n).count == 1) return place_of(loaded.scene, light(n));
        return (NODE_IS_INFINITE(node(n)) ? "from " : "round ") + show(centre(node(n)));
    }
    // In the file's frame, or a direction.
    [[nodiscard]] glm::dvec3 centre(const LightNode& n) const {
        const glm::vec3 centre(n.centre);
        return NODE_IS_INFINITE(n) ? glm::dvec3(centre) : loaded.scene.in_file(centre);
    }
};

// What a pixel's surface emits to the camera.
glm::vec3 emission_of(const PixelReport& report) {
    if (!report.hit()) return glm::vec3(0);
    const float4& emission = report.material.emission;
    return report.surface.front || emission.w != 0 ? glm::vec3(emission) : glm::vec3(0);
}

Inspected rank(const LoadedScene& loaded, const LightTree& tree, const PixelReport& report) {
    Inspected out{loaded, tree, report, report.nodes, 0, report.draws(), 0, {}, {}};
    out.luminance = reference::luminance(report.radiance);
    out.emitted = emission_of(report);
    std::ranges::stable_sort(out.ranked, std::greater(), [&](const InspectedNode& n) {
        return std::max({out.light_share(n), out.draw_share(n), n.noise});
    });
    return out;
}

std::string percent(double share) { return fmt::format("{:.3g}%", 100 * share); }

std::string seen_text(const Inspected& in, const InspectedNode& n) {
    if (n.facing == 0) return "faces away";
    if (in.node(n).count == 1) return n.seen ? "yes" : "no";
    return fmt::format("{} of {}", n.seen, n.facing);
}

// Why a node makes noise.
std::string reason(const Inspected& in, const InspectedNode& n) {
    const double light = in.light_share(n);
    const double draws = in.draw_share(n);
    if (n.facing == 0)
        return fmt::format("cannot light this pixel but gets {} of the draws", percent(draws));
    if (n.seen == 0)
        return fmt::format(
            "is hidden here, but the sampler reckons with V^ {:.2f}, which only {:.3f} draws in a "
            "sample correct",
            n.visibility, n.draws);
    const std::string both = fmt::format("gives {} of the light and gets {} of the draws",
                                         percent(light), percent(draws));
    if (light > draws && n.visibility < believed_hidden)
        return fmt::format("{}, being believed hidden (V^ {:.2f})", both, n.visibility);
    if (light > 1.5 * draws) return both + ", being estimated too low";
    if (draws > 1.5 * light) return both + ", being estimated too high";
    if (n.seen > 0 && n.seen < n.facing)
        return fmt::format("{}, and only {} of its {} lights are visible", both, n.seen, n.facing);
    return both;
}

std::vector<std::string> explain(const Inspected& in) {
    if (in.luminance == 0 && in.report.variance == 0)
        return {"It reflects no light, and has no noise."};
    if (in.luminance == 0)
        return {
            fmt::format("It reflects no light; a pixel sample deviates by {:.3g} cd/m2, where "
                        "lights that are hidden here are drawn.",
                        std::sqrt(in.report.variance))};
    std::vector<std::string> out = {
        fmt::format("A pixel sample here deviates by {} of the light, for the choice of lights; "
                    "the mean of {} by {}.",
                    percent(in.deviation()), in.spp,
                    percent(in.deviation() / std::sqrt(static_cast<double>(in.spp))))};
    const InspectedNode& worst = *std::ranges::max_element(in.ranked, {}, &InspectedNode::noise);
    if (in.report.count_noise > worst.noise)
        out.push_back(fmt::format(
            "The largest part of that variance, {}, is by the number of draws: {:.0f} or {:.0f}.",
            percent(in.report.count_noise), std::floor(in.draws), std::ceil(in.draws)));
    else if (worst.noise > 0)
        out.push_back(fmt::format("The largest part of that variance, {}, is by {} {}: it {}.",
                                  percent(worst.noise), in.name(worst), in.place(worst),
                                  reason(in, worst)));
    const double off = luminance(in.rendered) - luminance(in.emitted) - in.luminance;
    const double expected = std::sqrt(in.report.variance / in.spp);
    if (std::abs(off) > 3 * expected && std::abs(off) > 0.01 * in.luminance)
        out.push_back(
            fmt::format("The rendered pixel is off by {:+.3g}%: its earlier samples knew less than "
                        "is known now, or it differs from its centre.",
                        100 * off / in.luminance));
    double hidden_light = 0;
    double hidden_draws = 0;
    for (const InspectedNode& n : in.ranked) {
        if (n.visibility < believed_hidden) hidden_light += in.light_share(n);
        if (n.contribution == 0) hidden_draws += in.draw_share(n);
    }
    out.push_back(
        fmt::format("{} of the light is by what the sampler believes hidden (V^ below {}); {} of "
                    "the draws go to what gives no light here.",
                    percent(hidden_light), believed_hidden, percent(hidden_draws)));
    return out;
}

std::string material_text(const Scene& scene, const PixelReport& report) {
    const Material& m = report.material;
    const uint index = report.surface.material;
    const std::string& name = scene.material_names[index];
    std::string text =
        name.empty() ? fmt::format("material {}", index) : fmt::format("material '{}'", name);
    text += fmt::format(", base colour {}", show(glm::vec3(m.base_color)));
    if (m.base_color.w == 0 && m.specular == 0) return text + ", Lambert";
    return text + fmt::format(", metallic {:.2g}, roughness {:.2g}", m.base_color.w,
                              std::sqrt(m.roughness));
}

void print(const Inspected& in, std::size_t rows) {
    const PixelReport& r = in.report;
    const Scene& scene = in.loaded.scene;
    uint facing = 0;
    uint seen = 0;
    for (const InspectedNode& n : r.nodes) {
        facing += n.facing;
        seen += n.seen;
    }
    say("surface: {}, normal {}, {:.2f} m from the camera\n",
        show(scene.in_file(r.surface.position)), show(glm::vec3(r.surface.normal)),
        r.surface.position.w);
    say("         {}\n", material_text(scene, r));
    say("lights:  of {}, {} face it, and it sees {} of those\n", scene.lights.size(), facing, seen);
    say("tile {}: a cut of {} nodes, of which {} are one light and {} are groups; refined to {} "
        "for this pixel\n",
        r.tile, r.cut_nodes, r.cut_lights, r.cut_nodes - r.cut_lights, r.nodes.size());
    say("light:   {:.4g} cd/m2 of all lights at the pixel's centre; rendered {:.4g} cd/m2\n",
        in.luminance, luminance(in.rendered));
    if (in.emitted != glm::vec3(0))
        say("         of which it emits {:.4g} cd/m2 itself\n", luminance(in.emitted));
    say("draws:   {:.2f} in a pixel sample\n\n", in.draws);
    rows = std::min(rows, in.ranked.size());
    say("{:>3}  {:<26} {:<28} {:>10} {:>7} {:>10} {:>5} {:>6} {:>11} {:>6}\n", "", "light", "",
        "true cd/m2", "of all", "weight", "V^", "draws", "visible", "noise");
    for (std::size_t i = 0; i < rows; ++i) {
        const InspectedNode& n = in.ranked[i];
        say("{:>3}  {:<26} {:<28} {:>10.4g} {:>6.1f}% {:>10.4g} {:>5.2f} {:>6.3f} {:>11} "
            "{:>5.1f}%\n",
            i + 1, in.name(n), in.place(n), n.contribution, 100 * in.light_share(n), n.weight,
            n.visibility, n.draws, seen_text(in, n), 100 * n.noise);
    }
    if (rows < in.ranked.size()) {
        double light = 0;
        double draws = 0;
        for (std::size_t i = rows; i < in.ranked.size(); ++i) {
            light += in.light_share(in.ranked[i]);
            draws += in.ranked[i].draws;
        }
        say("     {} more: {} of the light, {:.3f} draws\n", in.ranked.size() - rows,
            percent(light), draws);
    }
    say("\n");
    for (const std::string& sentence : explain(in)) say("{}\n", sentence);
}

json to_json(const Inspected& in, std::size_t rows) {
    json nodes = json::array();
    for (std::size_t i = 0; i < std::min(rows, in.ranked.size()); ++i) {
        const InspectedNode& n = in.ranked[i];
        const LightNode& node = in.node(n);
        json entry = node.count == 1 ? describe(in.loaded.scene, in.light(n)) : json::object();
        if (node.count > 1)
            entry[NODE_IS_INFINITE(node) ? "direction" : "position"] = vector_json(in.centre(node));
        entry.update({{"node", n.node},
                      {"lights", node.count},
                      {"lights_facing", n.facing},
                      {"lights_visible", n.seen},
                      {"contribution", n.contribution},
                      {"weight", n.weight},
                      {"visibility", n.visibility},
                      {"draws", n.draws},
                      {"noise_share", n.noise}});
        nodes.push_back(std::move(entry));
    }
    const PixelReport& r = in.report;
    return {
        {"cut", {{"nodes", r.cut_nodes}, {"lights", r.cut_lights}, {"refined", r.nodes.size()}}},
        {"area_points", r.area_points},
        {"radiance", vector_json(glm::vec3(r.radiance))},
        {"luminance", in.luminance},
        {"rendered", vector_json(in.rendered)},
        {"draws", in.draws},
        {"deviation", std::sqrt(r.variance)},
        {"relative_deviation", in.deviation()},
        {"count_noise_share", r.count_noise},
        {"explanation", explain(in)},
        {"ranked", nodes}};
}

json surface_json(const Scene& scene, const Surface& s) {
    return {{"position", vector_json(scene.in_file(s.position))},
            {"normal", vector_json(glm::vec3(s.normal))},
            {"distance", s.position.w},
            {"triangle", s.triangle},
            {"material", s.material},
            {"material_name", scene.material_names[s.material]}};
}

PixelPicture make_picture(const Inspected& in, std::size_t rows) {
    const PixelReport& r = in.report;
    PixelPicture out{r.pixel, ADAPTIVE_TILE, {}, {}};
    out.lines.push_back(fmt::format("pixel {}, {}: {:.3g} cd/m2, {:.1f} draws in a sample",
                                    r.pixel.x, r.pixel.y, in.luminance, in.draws));
    out.lines.push_back(fmt::format("deviation of a sample, for the choice of lights: {}",
                                    percent(in.deviation())));
    for (std::size_t i = 0; i < std::min(rows, in.ranked.size()); ++i)
        out.bars.push_back(
            {fmt::format("{}, V^ {:.2f}", in.name(in.ranked[i]), in.ranked[i].visibility),
             in.light_share(in.ranked[i]), in.draw_share(in.ranked[i]), in.ranked[i].noise});
    return out;
}

void check_files(const InspectArguments& arguments, const std::string& picture) {
    const std::string ending = ".png";
    check_output("--output", picture, {&ending, 1});
    if (!arguments.json.empty()) check_output("--json", arguments.json);
    for (const auto& [option, path] :
         {std::pair{"--output", &picture}, std::pair{"--json", &arguments.json}})
        if (same_file(*path, arguments.scene.file))
            throw InputError("{} {}: is the scene itself", option, *path);
    if (same_file(picture, arguments.json))
        throw InputError("--json {}: is written by --output too", arguments.json);
}

}  // namespace

int run_inspect(const InspectArguments& arguments) {
    std::string file = arguments.output;
    if (file.empty())
        file = std::filesystem::path(arguments.scene.file).stem().string() + "-pixel.png";
    check_files(arguments, file);
    const auto compilers = std::make_shared<Compilers>(arguments.scene.threads);
    const LoadedScene loaded = load(arguments.scene);
    refuse_scene_file(loaded.scene, "--output", file);
    const glm::uvec2 pixel(arguments.x, arguments.y);
    if (pixel.x >= loaded.width || pixel.y >= loaded.height)
        throw InputError("{}: --pixel {},{}: is outside the image of {} x {} pixels",
                         loaded.scene.file, pixel.x, pixel.y, loaded.width, loaded.height);
    RenderOptions options = arguments.options;
    options.sampler = "adaptive";
    options.width = loaded.width;
    options.height = loaded.height;
    Device device =
        Device::open(arguments.scene.device, arguments.scene.threads, arguments.scene.lanes);
    device.help(compilers);
    const WideBvh bvh = build_bvh(loaded, device);
    Frame frame(device, loaded.scene, bvh, loaded.camera, options);
    if (frame.plan().batches > 1) {
        const std::size_t most = options.memory > 0 ? options.memory : frame.plan().total_bytes();
        throw InputError(
            "--memory: {:.1f} MiB{} is too little to keep what is learned of {} x {} pixels at "
            "once; a smaller --height needs less",
            static_cast<double>(most) / (1 << 20), options.memory > 0 ? "" : " (the default)",
            options.width, options.height);
    }
    frame.prepare();
    const FrameResult result = [&] {
        Progress progress("rendering");
        return frame.render(progress);
    }();

    const Tiles tiles = all_tiles(options.width, options.height, ADAPTIVE_TILE);
    const uint tile = pixel.y / tiles.size * tiles.columns + pixel.x / tiles.size;
    const bool lit = !loaded.scene.lights.empty();
    const PixelReport report =
        inspect_pixel(loaded.scene, frame.tree(), loaded.camera, tiles, pixel,
                      lit ? dynamic_cast<Adaptive&>(frame.sampler()).knowledge(tile)
                          : TileKnowledge{{}, {}, {1, 0, 0}, 1, 1});
    Inspected in = rank(loaded, frame.tree(), report);
    in.spp = options.spp;
    const float* rgb = result.image.at(pixel.x, pixel.y);
    in.rendered = {rgb[0], rgb[1], rgb[2]};

    json out = {{"version", MANYLIGHT_VERSION},
                {"scene", loaded.scene.file},
                {"camera", loaded.view.name},
                {"width", options.width},
                {"height", options.height},
                {"light_samples", options.light_samples},
                {"spp", options.spp},
                {"seed", options.seed},
                {"lights", loaded.scene.lights.size()},
                {"pixel", {pixel.x, pixel.y}},
                {"tile", tile},
                {"hit", report.hit()}};
    PixelPicture picture{pixel, ADAPTIVE_TILE, {}, {}};
    say("pixel {}, {} of {} x {}, {} light samples, {} spp\n", pixel.x, pixel.y, options.width,
        options.height, options.light_samples, options.spp);
    std::string nothing;
    if (!report.hit())
        nothing = "It sees nothing: no light is drawn, and it is black without noise.";
    else if (!lit)
        nothing = "The scene has no lights: none is drawn, and the pixel has no noise.";
    if (report.hit()) out["surface"] = surface_json(loaded.scene, report.surface);
    if (nothing.empty()) {
        print(in, arguments.top_lights);
        out.update(to_json(in, arguments.top_lights));
        picture = make_picture(in, arguments.top_lights);
    } else {
        say("{}\n", nothing);
        out["explanation"] = {nothing};
        picture.lines = {fmt::format("pixel {}, {}", pixel.x, pixel.y), nothing};
    }
    write_png(file, draw_pixel_picture(result.image, picture), 1, {});
    say("\nwrote {}\n", file);
    if (!arguments.json.empty()) {
        const std::string text = out.dump(2, ' ', true, json::error_handler_t::replace) + "\n";
        write_file(arguments.json, std::as_bytes(std::span(text)));
        say("wrote {}\n", arguments.json);
    }
    return 0;
}

}  // namespace manylight

// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "commands/commands.hpp"
#include "commands/describe.hpp"
#include "commands/inspected.hpp"
#include "error.hpp"
#include "output/pixel_picture.hpp"
#include "output/write_file.hpp"
#include "pipeline/frame.hpp"
#include "print.hpp"
#include "reference/shading.hpp"

namespace manylight {
namespace {

using nlohmann::json;

std::string seen_text(const Inspected& in, const InspectedNode& n) {
    if (n.facing == 0) return "faces away";
    if (in.node(n).count == 1) return n.seen ? "yes" : "no";
    return fmt::format("{} of {}", n.seen, n.facing);
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

// Of the image that the sampler learns from.
RenderOptions options_of(const InspectArguments& arguments, const LoadedScene& loaded) {
    RenderOptions options = arguments.options;
    options.sampler = "adaptive";
    options.width = loaded.width;
    options.height = loaded.height;
    return options;
}

void check_memory(const Plan& plan, const RenderOptions& options) {
    if (plan.batches == 1) return;
    const std::size_t most = options.memory > 0 ? options.memory : plan.total_bytes();
    throw InputError(
        "--memory: {:.1f} MiB{} is too little to keep what is learned of {} x {} pixels at "
        "once; a smaller --height needs less",
        static_cast<double>(most) / (1 << 20), options.memory > 0 ? "" : " (the default)",
        options.width, options.height);
}

json facts_of(const LoadedScene& loaded, const RenderOptions& options, const PixelReport& report) {
    return {{"version", MANYLIGHT_VERSION},
            {"scene", loaded.scene.file},
            {"camera", loaded.view.name},
            {"width", options.width},
            {"height", options.height},
            {"light_samples", options.light_samples},
            {"spp", options.spp},
            {"seed", options.seed},
            {"lights", loaded.scene.lights.size()},
            {"pixel", {report.pixel.x, report.pixel.y}},
            {"tile", report.tile},
            {"hit", report.hit()}};
}

// What is said of a pixel that there is nothing to say of; empty otherwise.
std::string why_nothing(const LoadedScene& loaded, const PixelReport& report) {
    if (!report.hit()) return "It sees nothing: no light is drawn, and it is black without noise.";
    if (loaded.scene.lights.empty())
        return "The scene has no lights: none is drawn, and the pixel has no noise.";
    return "";
}

// Prints what was found, and writes the files.
void write_report(const InspectArguments& arguments, const std::string& file,
                  const RenderOptions& options, const Inspected& in, const Image& image) {
    const PixelReport& report = in.report;
    const glm::uvec2 pixel = report.pixel;
    json out = facts_of(in.loaded, options, report);
    PixelPicture picture{pixel, ADAPTIVE_TILE, {}, {}};
    say("pixel {}, {} of {} x {}, {} light samples, {} spp\n", pixel.x, pixel.y, options.width,
        options.height, options.light_samples, options.spp);
    if (report.hit()) out["surface"] = surface_json(in.loaded.scene, report.surface);
    const std::string nothing = why_nothing(in.loaded, report);
    if (nothing.empty()) {
        print(in, arguments.top_lights);
        out.update(to_json(in, arguments.top_lights));
        picture = make_picture(in, arguments.top_lights);
    } else {
        say("{}\n", nothing);
        out["explanation"] = {nothing};
        picture.lines = {fmt::format("pixel {}, {}", pixel.x, pixel.y), nothing};
    }
    write_png(file, draw_pixel_picture(image, picture), 1, {});
    say("\nwrote {}\n", file);
    if (!arguments.json.empty()) {
        const std::string text = out.dump(2, ' ', true, json::error_handler_t::replace) + "\n";
        write_file(arguments.json, std::as_bytes(std::span(text)));
        say("wrote {}\n", arguments.json);
    }
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
    const RenderOptions options = options_of(arguments, loaded);
    Device device =
        Device::open(arguments.scene.device, arguments.scene.threads, arguments.scene.lanes);
    device.help(compilers);
    const WideBvh bvh = build_bvh(loaded, device);
    Frame frame(device, loaded.scene, bvh, loaded.camera, options);
    check_memory(frame.plan(), options);
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
    write_report(arguments, file, options, in, result.image);
    return 0;
}

}  // namespace manylight

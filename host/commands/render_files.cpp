// SPDX-License-Identifier: MIT
#include "commands/render_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "error.hpp"
#include "output/cluster_map.hpp"
#include "output/write_file.hpp"

namespace manylight {

using nlohmann::json;
namespace fs = std::filesystem;

std::vector<std::pair<std::string, std::string>> files_of(const RenderArguments& arguments,
                                                          const std::vector<std::string>& images) {
    std::vector<std::pair<std::string, std::string>> files;
    for (const std::string& image : images) files.emplace_back("--output", image);
    if (!arguments.cluster_map.empty()) files.emplace_back("--cluster-map", arguments.cluster_map);
    if (!arguments.stats.empty()) files.emplace_back("--stats", arguments.stats);
    if (!arguments.checkpoint.empty()) files.emplace_back("--checkpoint", arguments.checkpoint);
    return files;
}

void check_files(const RenderArguments& arguments, const std::vector<std::string>& images) {
    const auto files = files_of(arguments, images);
    for (const auto& [option, path] : files) {
        std::vector<std::string> endings;
        if (option == "--output") endings = {".exr", ".png"};
        if (option == "--cluster-map") endings = {".png"};
        check_output(option, path, endings);
    }
    for (std::size_t i = 0; i < files.size(); ++i) {
        const auto& [option, path] = files[i];
        if (same_file(path, arguments.scene.file))
            throw InputError("{} {}: is the scene itself", option, path);
        for (std::size_t j = 0; j < i; ++j)
            if (same_file(path, files[j].second))
                throw InputError("{} {}: is written by {} too", option, path, files[j].first);
    }
}

void check_checkpoint(const RenderArguments& arguments) {
    if (arguments.checkpoint.empty()) return;
    if (arguments.seconds > 0)
        throw InputError("--checkpoint {}: not with --time, which ends where the machine is",
                         arguments.checkpoint);
    std::error_code error;
    if (!arguments.resume && fs::exists(arguments.checkpoint, error))
        throw InputError(
            "--checkpoint {}: is there already; add --resume to go on from it, or "
            "remove it",
            arguments.checkpoint);
}

std::optional<Checkpoint> find_checkpoint(const RenderArguments& arguments) {
    std::error_code error;
    if (!arguments.resume || !fs::exists(arguments.checkpoint, error)) return {};
    return read_checkpoint(arguments.checkpoint);
}

Clock::time_point deadline_of(const RenderArguments& arguments,
                              const std::vector<std::string>& images, const LoadedScene& loaded) {
    // Seconds that encoding a pixel takes, of a layer where there are several.
    constexpr double exr = 450e-9;
    constexpr double png = 450e-9;
    const double pixels = static_cast<double>(loaded.width) * loaded.height;
    double writing = 0.03;
    for (const std::string& image : images)
        writing += pixels * (image.ends_with(".exr")
                                 ? exr * static_cast<double>(1 + arguments.options.aovs.size())
                                 : png);
    return process_start() + std::chrono::duration_cast<Clock::duration>(
                                 std::chrono::duration<double>(arguments.seconds - writing));
}

void write_images(const RenderArguments& arguments, const std::vector<std::string>& images,
                  const FrameResult& result, const Metadata& metadata) {
    // By as many stops as the header says, so that these make the same picture.
    const float stops = arguments.exposure.value_or(std::log2(auto_exposure(result.image)));
    const float exposure = std::exp2(stops);
    Metadata exposed = metadata;
    exposed["manylight:exposure"] = fmt::format("{}", stops);
    std::vector<Image> layers = {result.image};
    for (const auto& [name, image] : result.aovs)
        if (std::ranges::count(arguments.options.aovs, name)) layers.push_back(image);
    for (const std::string& path : images) {
        if (path.ends_with(".exr"))
            write_exr(path, layers, metadata);
        else
            write_png(path, result.image, exposure, exposed);
    }
    if (!arguments.cluster_map.empty())
        write_png(arguments.cluster_map, draw_cluster_map(result.image, exposure, result.aovs), 1,
                  exposed);
}

void write_stats(const std::string& path, const json& stats) {
    if (path.empty()) return;
    const std::string text = stats.dump(2, ' ', true, json::error_handler_t::replace) + "\n";
    write_file(path, std::as_bytes(std::span(text)));
}

}  // namespace manylight

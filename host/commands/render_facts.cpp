// SPDX-License-Identifier: MIT
#include "commands/render_facts.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

#include "commands/repeat.hpp"

namespace manylight {

using nlohmann::json;

OptionList options_of(const RenderArguments& arguments, const RenderOptions& options,
                      const LoadedScene& loaded, const Device& device, const FrameResult& result) {
    SceneArguments scene = arguments.scene;
    if (scene.camera.empty() && !loaded.scene.views.empty()) scene.camera = loaded.view.name;
    scene.emitter_points = loaded.emitter_points;
    scene.headlight = loaded.headlight ? Headlight::always : Headlight::never;
    OptionList list = view_options(scene);
    for (auto& option : image_options(options)) list.push_back(std::move(option));
    if (result.spp == std::floor(result.spp))
        list.emplace_back("spp", static_cast<uint>(result.spp));
    else
        list.emplace_back("spp", result.spp);
    if (options.memory > 0) list.emplace_back("memory", options.memory);
    list.emplace_back("device", device.info().name);
    const unsigned lanes = device.form().lanes;
    list.emplace_back("device-form", lanes == 1 ? "gpu" : std::to_string(lanes));
    return list;
}

json make_stats(const OptionList& options, bool estimates_error, const LoadedScene& loaded,
                const Plan& plan, const FrameResult& result, Device& device) {
    json stats = {{"version", MANYLIGHT_VERSION},
                  {"platform", device.info().platform},
                  {"first_light_samples", result.light_samples},
                  {"later_light_samples", result.later_light_samples}};
    for (const auto& [option, value] : options) stats[field_of(option)] = value;
    stats["triangles"] = loaded.scene.seen_triangle_count();
    stats["lights"] = loaded.scene.lights.size();
    stats["clusters"] = result.clusters;
    stats["batches"] = plan.batches;
    stats["cut_short"] = result.is_cut_short;
    stats["rays"] = {{"primary", result.primary_rays}, {"shadow", result.shadow_rays}};
    stats["memory_bytes"] = {{"device_peak", device.peak_bytes()},
                             {"planned", plan.total_bytes()},
                             {"matrix", plan.matrix_bytes}};
    if (estimates_error)
        stats["error"] = result.error ? json{{"relmse", result.error->relmse},
                                             {"standard_error", result.error->standard_error}}
                                      : json();
    const std::map<std::string, double> stages = device.stage_seconds();
    stats["stage_seconds"] = stages;
    const auto shadows = stages.find("shadows");
    if (shadows != stages.end() && shadows->second > 0 && !result.is_resumed)
        stats["shadow_mrays_per_s"] =
            static_cast<double>(result.shadow_rays) / shadows->second / 1e6;
    return stats;
}

Metadata make_metadata(const OptionList& options, const FrameResult& result, double seconds,
                       const Device& device) {
    Metadata metadata = {
        {"Software", "manylight " MANYLIGHT_VERSION},
        {"manylight:version", MANYLIGHT_VERSION},
        {"manylight:platform", device.info().platform},
        {"manylight:first_light_samples", std::to_string(result.light_samples)},
        {"manylight:later_light_samples", std::to_string(result.later_light_samples)},
        {"manylight:cut_short", result.is_cut_short ? "true" : "false"},
        {"manylight:seconds", static_cast<float>(seconds)}};
    // As text: a seed may not fit a signed integer, nor a number a float.
    for (const auto& [option, value] : options)
        metadata["manylight:" + field_of(option)] = text_of(value);
    return metadata;
}

}  // namespace manylight

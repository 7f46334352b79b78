// SPDX-License-Identifier: MIT
#include "pipeline/image_options.hpp"

#include <fmt/format.h>

#include "samplers/table.hpp"

namespace manylight {
namespace {

// The shortest decimal number that is this one.
double shortest(float value) { return std::stod(fmt::to_string(value)); }

}  // namespace

OptionList image_options(const RenderOptions& options) {
    const ClusterOptions& clusters = options.clusters;
    OptionList list = {{"sampler", options.sampler},
                       {"seed", options.seed},
                       {"width", options.width},
                       {"height", options.height},
                       {"pixel-centre", options.pixel_centre},
                       {"hide-emitters", options.hide_emitters},
                       {"no-reflections", !options.reflections},
                       {"tile-size", clusters.tile_size},
                       {"max-depth", clusters.max_depth},
                       {"normal-threshold", shortest(clusters.normal_threshold)},
                       {"visibility-threshold", shortest(clusters.shadow.threshold)}};
    const ParameterValues parameters = values_of(find_sampler(options.sampler), options.parameters);
    if (!parameters.empty()) list.emplace_back("set", text_of(parameters));
    if (options.light_samples > 0) list.emplace_back("light-samples", options.light_samples);
    if (options.target_error > 0)
        list.emplace_back("target-error", options.target_error);
    else if (options.estimates_error())
        list.emplace_back("aov", "error");
    return list;
}

std::string text_of(const nlohmann::json& value) {
    return value.is_string() ? value.get<std::string>() : value.dump();
}

}  // namespace manylight

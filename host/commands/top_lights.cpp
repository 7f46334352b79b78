// SPDX-License-Identifier: MIT
#include "explain/top_lights.hpp"

#include <fmt/format.h>

#include "clock.hpp"
#include "commands/commands.hpp"
#include "commands/describe.hpp"
#include "print.hpp"

namespace manylight {

nlohmann::json report_top_lights(const LoadedScene& loaded, unsigned count, uint seed, bool quiet) {
    const auto start = Clock::now();
    const TopLights found =
        find_top_lights(loaded.scene, loaded.camera, loaded.width, loaded.height, count, seed);
    nlohmann::json lights = nlohmann::json::array();
    for (const TopLight& top : found.lights) {
        nlohmann::json entry = describe(loaded.scene, top.light);
        entry.update(
            {{"share", top.share}, {"standard_error", top.standard_error}, {"seen", top.seen}});
        lights.push_back(std::move(entry));
    }
    nlohmann::json out = {
        {"points", found.points},           {"light_samples", found.light_samples},
        {"shadow_rays", found.shadow_rays}, {"luminance", found.luminance},
        {"seconds", seconds_since(start)},  {"lights", lights}};
    if (quiet) return out;
    if (found.lights.empty()) {
        say("\nno light reaches the image\n\n");
        return out;
    }
    say("\n{:>3}  {:<26} {:<28} {:>17} {:>12}\n", "", "light", "", "of the light", "seen from");
    double sum = 0;
    for (std::size_t i = 0; i < found.lights.size(); ++i) {
        const TopLight& top = found.lights[i];
        sum += top.share;
        say("{:>3}  {:<26} {:<28} {:>6.2f}% +- {:>5.2f}% {:>11.1f}%\n", i + 1,
            name_of(loaded.scene, top.light), place_of(loaded.scene, top.light), 100 * top.share,
            100 * top.standard_error, 100 * top.seen);
    }
    const std::string how =
        found.light_samples == 0
            ? "all lights"
            : fmt::format("{} draws from the light tree for the total, then the listed lights",
                          found.light_samples);
    say("     together {:.1f}% of what lights give the image; estimated at {} of its points ({}), "
        "+- is one standard error\n\n",
        100 * sum, found.points, how);
    return out;
}

}  // namespace manylight

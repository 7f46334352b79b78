// SPDX-License-Identifier: MIT
#include <nlohmann/json.hpp>

#include "commands/commands.hpp"
#include "print.hpp"
#include "samplers/table.hpp"

namespace manylight {

int run_samplers(bool as_json) {
    const std::span<const Sampler> samplers = all_samplers();
    if (as_json) say("[\n");
    for (const Sampler& s : samplers) {
        if (!as_json) {
            say("{:24}{}{}\n", s.name, s.summary, s.biased ? "; biased" : "");
            continue;
        }
        const nlohmann::json row = {{"name", s.name},
                                    {"summary", s.summary},
                                    {"color", s.color},
                                    {"biased", s.biased},
                                    {"all_lights", s.all_lights}};
        say("  {}{}\n", row.dump(), &s == &samplers.back() ? "" : ",");
    }
    if (as_json) say("]\n");
    return 0;
}

}  // namespace manylight

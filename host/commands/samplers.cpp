// SPDX-License-Identifier: MIT
#include <nlohmann/json.hpp>

#include "commands/commands.hpp"
#include "print.hpp"
#include "samplers/table.hpp"

namespace manylight {

namespace {

nlohmann::json parameters_of(const Sampler& sampler) {
    nlohmann::json list = nlohmann::json::array();
    for (const Parameter& p : sampler.parameters)
        list.push_back({{"name", p.name},
                        {"value", p.value},
                        {"least", p.least},
                        {"most", p.most},
                        {"whole", p.whole},
                        {"summary", p.summary}});
    return list;
}

}  // namespace

int run_samplers(bool as_json) {
    const std::span<const Sampler> samplers = all_samplers();
    if (as_json) say("[\n");
    for (const Sampler& s : samplers) {
        if (!as_json) {
            say("{:24}{}{}\n", s.name, s.summary, s.biased ? "; biased" : "");
            for (const Parameter& p : s.parameters)
                say("{:26}--set {}={}: {}\n", "", p.name, p.value, p.summary);
            continue;
        }
        const nlohmann::json row = {{"name", s.name},
                                    {"summary", s.summary},
                                    {"color", s.color},
                                    {"biased", s.biased},
                                    {"all_lights", s.all_lights},
                                    {"own_rays", s.own_rays},
                                    {"parameters", parameters_of(s)}};
        say("  {}{}\n", row.dump(), &s == &samplers.back() ? "" : ",");
    }
    if (as_json) say("]\n");
    return 0;
}

}  // namespace manylight

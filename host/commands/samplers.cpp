// SPDX-License-Identifier: MIT
#include <nlohmann/json.hpp>

#include "commands/commands.hpp"
#include "print.hpp"
#include "samplers/table.hpp"

namespace manylight {

int run_samplers(bool as_json) {
    nlohmann::json list = nlohmann::json::array();
    for (const Sampler& s : all_samplers()) {
        if (as_json)
            list.push_back({{"name", s.name},
                            {"summary", s.summary},
                            {"color", s.color},
                            {"biased", s.biased},
                            {"all_lights", s.all_lights}});
        else
            say("{:24}{}{}\n", s.name, s.summary, s.biased ? "; biased" : "");
    }
    if (as_json) say("{}\n", list.dump(2));
    return 0;
}

}  // namespace manylight

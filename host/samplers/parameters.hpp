// SPDX-License-Identifier: MIT
#pragma once

#include <map>
#include <string>
#include <string_view>

namespace manylight {

/// A number of a sampler that users may set, with --set NAME=VALUE.
struct Parameter {
    std::string_view name;
    double value;  // where it is not set
    double least, most;
    std::string_view summary;  // one line for help
    bool whole = false;        // a number without a fraction
};

/// Values of a sampler's parameters by their names.
using ParameterValues = std::map<std::string, double, std::less<>>;

}  // namespace manylight

// SPDX-License-Identifier: MIT
// The options that an image depends on, as one list: for headers, reports and checkpoints.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "pipeline/plan.hpp"

namespace manylight {

/// Options by their names on the command line, without dashes. A flag's value is true or false.
using OptionList = std::vector<std::pair<std::string, nlohmann::json>>;

/// Those of a frame that its pixel samples depend on: not how many there are, nor the scene, the
/// camera and the device.
[[nodiscard]] OptionList image_options(const RenderOptions& options);

/// A value as it is written on the command line.
[[nodiscard]] std::string text_of(const nlohmann::json& value);

}  // namespace manylight

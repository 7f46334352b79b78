// SPDX-License-Identifier: MIT
// Options of a run that is done, for another one like it.
#pragma once

#include <string>

#include "commands/commands.hpp"
#include "pipeline/image_options.hpp"

namespace manylight {

/// The file and the options that say what of it is seen and how, but for the image's size.
[[nodiscard]] OptionList view_options(const SceneArguments& scene);

/// The same as words of a command line, for a shell, the file first; nothing that says what is so
/// anyway.
[[nodiscard]] std::string view_words(const SceneArguments& scene);

/// As a shell takes it for one word.
[[nodiscard]] std::string quote(const std::string& word);

/// The field of an image's header that an option has: light_samples for light-samples.
[[nodiscard]] std::string field_of(std::string option);

}  // namespace manylight

// SPDX-License-Identifier: MIT
// What is told of a render that is done, in --stats and in images' headers.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "commands/commands.hpp"
#include "output/image.hpp"
#include "pipeline/image_options.hpp"

namespace manylight {

/// All options that the image depends on, and the pixel samples that it has: with as many, they
/// repeat it.
[[nodiscard]] OptionList options_of(const RenderArguments& arguments, const RenderOptions& options,
                                    const LoadedScene& loaded, const Device& device,
                                    const FrameResult& result);

/// Without the seconds. `estimates_error`: see RenderOptions.
[[nodiscard]] nlohmann::json make_stats(const OptionList& options, bool estimates_error,
                                        const LoadedScene& loaded, const Plan& plan,
                                        const FrameResult& result, Device& device);

/// `seconds`: from the program's start.
[[nodiscard]] Metadata make_metadata(const OptionList& options, const FrameResult& result,
                                     double seconds, const Device& device);

}  // namespace manylight

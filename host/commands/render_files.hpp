// SPDX-License-Identifier: MIT
// Files that a render reads and writes.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "clock.hpp"
#include "commands/commands.hpp"
#include "output/checkpoint.hpp"
#include "output/image.hpp"

namespace manylight {

/// The files to be made, with the options that name them. `images`: of --output.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> files_of(
    const RenderArguments& arguments, const std::vector<std::string>& images);

/// Before any work: every file can be written, and none is the scene or another one. Throws
/// InputError.
void check_files(const RenderArguments& arguments, const std::vector<std::string>& images);

/// A checkpoint is hours of work: none is lost by forgetting an option. Throws InputError.
void check_checkpoint(const RenderArguments& arguments);

/// What to go on from, if asked for and there.
[[nodiscard]] std::optional<Checkpoint> find_checkpoint(const RenderArguments& arguments);

/// When rendering has to end for everything to be written in time.
[[nodiscard]] Clock::time_point deadline_of(const RenderArguments& arguments,
                                            const std::vector<std::string>& images,
                                            const LoadedScene& loaded);

/// The images, and the picture of the clusters.
void write_images(const RenderArguments& arguments, const std::vector<std::string>& images,
                  const FrameResult& result, const Metadata& metadata);

/// As JSON; nothing where `path` is empty.
void write_stats(const std::string& path, const nlohmann::json& stats);

}  // namespace manylight

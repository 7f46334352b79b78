// SPDX-License-Identifier: MIT
// Options that several commands have: of the scene and what is seen of it, and of clusters; and the
// lists below their help.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "commands/commands.hpp"

namespace manylight::options {

/// What a command that renders a scene needs beside its file; `height`: of the image, for the help.
void add_view(CLI::App& command, SceneArguments& scene, unsigned height = 512);

/// The same and the file.
void add_scene(CLI::App& command, SceneArguments& scene, unsigned height = 512);

void add_clusters(CLI::App& command, ClusterOptions& clusters);

/// All samplers for a command's help; `automatic`: with the choice of one.
[[nodiscard]] std::string sampler_list(bool automatic);

/// All layers for a command's help.
[[nodiscard]] std::string aov_list();

}  // namespace manylight::options

// SPDX-License-Identifier: MIT
// Which checks are run.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace manylight {

/// Names by list; an empty list takes all.
struct Selection {
    std::vector<std::string> stages;
    std::vector<std::string> samplers;  // whose stages; no others, unless `stages` names them
    std::vector<std::string> scenes;    // of the program's own

    [[nodiscard]] bool everything() const {
        return stages.empty() && samplers.empty() && scenes.empty();
    }
    [[nodiscard]] bool takes_stage(std::string_view stage) const;
    /// Of these stages at least one.
    [[nodiscard]] bool takes_one_of(std::span<const std::string_view> of) const;
    [[nodiscard]] bool takes_sampler(std::string_view sampler) const;
    [[nodiscard]] bool takes_scene(std::string_view scene) const;

    /// As options of `verify`: "--stage pdf,samples --sampler power".
    [[nodiscard]] std::string words() const;
};

}  // namespace manylight

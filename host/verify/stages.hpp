// SPDX-License-Identifier: MIT
// What judges a stage: one row for each, in the order in which they are judged and printed.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "verify/verify.hpp"

/// The list of stages: the one place that names them all. For each, host/verify/stages/ has
/// check_NAME(), its row; that of `samplers` walks the table of samplers (sampler_checks.hpp).
#define MANYLIGHT_STAGES(ROW) \
    ROW(layout)               \
    ROW(random)               \
    ROW(gbuffer)              \
    ROW(emitter_parts)        \
    ROW(clusters)             \
    ROW(representatives)      \
    ROW(contributions)        \
    ROW(refinement)           \
    ROW(accumulate)           \
    ROW(cells)                \
    ROW(samplers)             \
    ROW(reflections)

namespace manylight {

struct StageCheck {
    /// The stages that its checks are of, as stage_of() and --stage have them: one, or those of all
    /// samplers.
    std::vector<std::string_view> stages = {};
    bool orthographic = false;  // judged for a camera without perspective as well
    bool receivers = false;     // judged for points that no camera sees as well
    bool of_samplers = false;   // its checks are of samplers
    std::vector<Check> (*run)(Verifier& verifier) = nullptr;
};

/// For `run`: the stage has one check.
template <Check (*check)(Verifier&)>
[[nodiscard]] std::vector<Check> single(Verifier& verifier) {
    return {check(verifier)};
}

[[nodiscard]] std::span<const StageCheck> all_stages();

/// The stages of all rows, each once.
[[nodiscard]] std::vector<std::string_view> stage_names();

/// The checks of one stage, whatever the verifier's options select. Throws std::logic_error for a
/// name that no row has.
[[nodiscard]] std::vector<Check> check_stage(Verifier& verifier, std::string_view stage);

/// The rows that a selection takes: of all, or, with `where`, of those of which that is true.
[[nodiscard]] std::vector<const StageCheck*> selected_stages(const Selection& selection,
                                                             bool StageCheck::*where = nullptr);

/// Runs rows; keeps the checks that the verifier's options select.
[[nodiscard]] std::vector<Check> run_stages(Verifier& verifier,
                                            const std::vector<const StageCheck*>& rows);

}  // namespace manylight

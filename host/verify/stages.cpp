// SPDX-License-Identifier: MIT
#include "verify/stages.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

namespace manylight {

#define DECLARE_ROW(name) StageCheck check_##name();
MANYLIGHT_STAGES(DECLARE_ROW)
#undef DECLARE_ROW

std::span<const StageCheck> all_stages() {
#define MAKE_ROW(name) check_##name(),
    static const StageCheck stages[] = {MANYLIGHT_STAGES(MAKE_ROW)};
#undef MAKE_ROW
    return stages;
}

std::vector<std::string_view> stage_names() {
    std::vector<std::string_view> names;
    for (const StageCheck& row : all_stages())
        for (const std::string_view stage : row.stages)
            if (std::ranges::find(names, stage) == names.end()) names.push_back(stage);
    return names;
}

std::vector<Check> check_stage(Verifier& verifier, std::string_view stage) {
    for (const StageCheck& row : all_stages()) {
        if (std::ranges::find(row.stages, stage) == row.stages.end()) continue;
        std::vector<Check> checks = row.run(verifier);
        std::erase_if(checks, [&](const Check& check) { return stage_of(check) != stage; });
        return checks;
    }
    throw std::logic_error(fmt::format("no row of stage {}", stage));
}

std::vector<const StageCheck*> selected_stages(const Selection& selection,
                                               bool StageCheck::*where) {
    std::vector<const StageCheck*> rows;
    for (const StageCheck& row : all_stages()) {
        if (where != nullptr && !(row.*where)) continue;
        // A sampler alone asks for its own stages, and no others.
        const bool taken = selection.stages.empty() ? selection.samplers.empty() || row.of_samplers
                                                    : selection.takes_one_of(row.stages);
        if (taken) rows.push_back(&row);
    }
    return rows;
}

std::vector<Check> run_stages(Verifier& verifier, const std::vector<const StageCheck*>& rows) {
    std::vector<Check> checks;
    for (const StageCheck* row : rows)
        for (Check& check : row->run(verifier))
            if (verifier.options().only.takes_stage(stage_of(check)))
                checks.push_back(std::move(check));
    return checks;
}

}  // namespace manylight

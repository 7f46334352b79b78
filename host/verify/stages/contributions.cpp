// SPDX-License-Identifier: MIT
// Stage contributions.
#include <cmath>

#include "reference/contributions.hpp"
#include "verify/stages.hpp"
#include "verify/tolerances.hpp"

namespace manylight {
namespace {

Check contributions(Verifier& verifier) {
    Check check{.stage = "contributions", .tolerance = shading_tolerance};
    verifier.send_out(verifier.found_surfaces());  // as when the matrix was made
    const std::vector<uint> representatives = verifier.clustering().representatives();
    const std::size_t lights = verifier.scene().lights.size();
    std::vector<reference::Contribution> agreeing;  // about which rays pass
    // An odd stride meets every light and row in turn.
    const std::size_t stride = (verifier.matrix().size() / verifier.options().most_entries) | 1;
    for (std::size_t i = 0; i < verifier.matrix().size(); i += stride) {
        const std::string where = fmt::format("row {}, light {}", i / lights, i % lights);
        const uint representative = representatives[i / lights];
        if (representative == NO_ITEM) {
            check.compare_exact(verifier.matrix()[i] == 0, where);
            continue;
        }
        const Surface& surface = verifier.found_surfaces()[representative];
        const Material& material = verifier.scene().materials[surface.shading];
        const reference::Viewer viewer = verifier.viewers().of(representative);
        const Light& light = verifier.scene().lights[i % lights];
        const reference::Contribution expected =
            reference::contribution(verifier.tracer(), surface, material, viewer, light);
        const double found = std::abs(verifier.matrix()[i]);
        double tolerance = shading_roundings * epsilon * expected.value;
        if (std::abs(found - expected.value) > tolerance / 4)
            tolerance += reference::rounding_slack(surface, material, viewer, light,
                                                   reference::centroid(light));
        check.compare(std::abs(found - expected.value), tolerance,
                      fmt::format("{}: {} is not {}", where, found, expected.value),
                      found == 0 && expected.value == 0);
        if (found == 0 || expected.value == 0) continue;
        if ((verifier.matrix()[i] < 0) == expected.hidden)
            agreeing.push_back(expected);
        else if (verifier.tracer().occlusion_is_borderline(expected.shadow, expected.rounding)) {
            ++check.borderline;
            check.excuse(1);
        } else
            check.compare(2, 1, where + ": visibility");
    }
    check.excuse_agreeing(agreeing.size(), [&](std::size_t i) {
        return verifier.tracer().occlusion_is_borderline(agreeing[i].shadow, agreeing[i].rounding)
                   ? 1
                   : 0;
    });
    const std::vector<RowSum> totals = verifier.clustering().totals();
    for (std::size_t row = 0; row < totals.size(); ++row) {
        const reference::RowTotal expected =
            reference::row_total(std::span(verifier.matrix()).subspan(row * lights, lights));
        // Sums in two levels: a chunk, then the chunks.
        const double roundings = LIGHT_CHUNK + chunk_count(static_cast<uint>(lights));
        const double tolerance = roundings * epsilon * expected.unshadowed;
        check.compare(std::abs(totals[row].visible - expected.visible), tolerance,
                      fmt::format("row {}: sum of the visible", row));
        check.compare(std::abs(totals[row].unshadowed - expected.unshadowed), tolerance,
                      fmt::format("row {}: sum", row));
        check.compare_exact(totals[row].visible_count == expected.visible_count &&
                                totals[row].facing_count == expected.facing_count,
                            fmt::format("row {}: counts", row));
    }
    return check;
}

}  // namespace

StageCheck check_contributions() {
    return {.stages = {"contributions"},
            .orthographic = true,
            .receivers = true,
            .run = single<contributions>};
}

}  // namespace manylight

// SPDX-License-Identifier: MIT
// Stage refinement.
#include "reference/refinement.hpp"
#include "verify/stages.hpp"
#include "verify/tolerances.hpp"

namespace manylight {
namespace {

Check refinement(Verifier& verifier) {
    Check check{.stage = "refinement", .tolerance = exact};
    if (verifier.scene().lights.empty()) return check;
    const auto count = static_cast<uint>(verifier.clustering().regions().size());
    const std::vector<RowSum> totals = verifier.clustering().totals();
    const Buffer<Region> regions = verifier.device().upload(verifier.clustering().regions());
    Buffer<uint> split = verifier.device().allocate<uint>(count);
    for (const bool weighed : {false, true}) {
        const ShadowRule rule{weighed, verifier.options().clusters.shadow.threshold};
        RefinementStage(verifier.device())
            .split(regions, verifier.clustering().matrix().totals, 0, count, rule,
                   verifier.options().clusters.max_depth, split);
        const std::vector<uint> found = split.download();
        const std::vector<uint> expected =
            reference::split_by_visibility(verifier.clustering().regions(), totals, weighed,
                                           rule.threshold, verifier.options().clusters.max_depth);
        for (uint i = 0; i < count; ++i)
            check.compare_exact(found[i] == expected[i],
                                fmt::format("region {}{}", i, weighed ? ", weighed" : ""));
    }
    return check;
}

}  // namespace

StageCheck check_refinement() { return {.stages = {"refinement"}, .run = single<refinement>}; }

}  // namespace manylight

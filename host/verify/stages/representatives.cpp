// SPDX-License-Identifier: MIT
// Stage representatives.
#include "reference/representatives.hpp"
#include "verify/stages.hpp"
#include "verify/tolerances.hpp"

namespace manylight {
namespace {

Check representatives(Verifier& verifier) {
    Check check{.stage = "representatives", .tolerance = exact};
    if (verifier.scene().lights.empty()) return check;
    const std::vector<uint> found = verifier.clustering().representatives();
    for (std::size_t i = 0; i < found.size(); ++i) {
        const Region& region = verifier.clustering().regions()[i];
        check.compare_exact(
            found[i] ==
                reference::representative(verifier.tiles(), verifier.found_surfaces(), region),
            fmt::format("region ({}, {}) of {} pixels", region.x, region.y, region.size));
    }
    return check;
}

}  // namespace

StageCheck check_representatives() {
    return {.stages = {"representatives"}, .run = single<representatives>};
}

}  // namespace manylight

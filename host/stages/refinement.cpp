// SPDX-License-Identifier: MIT
#include "stages/refinement.hpp"

namespace manylight {

RefinementStage::RefinementStage(Device& device)
    : split_(device.kernel("refinement.cl", "refinement_split", {}, "refinement")) {}

void RefinementStage::split(const Buffer<Region>& regions, const Buffer<RowSum>& totals, uint first,
                            uint count, const ShadowRule& rule, uint max_level,
                            Buffer<uint>& split) {
    split_.launch(count, Arguments()
                             .set("regions", regions)
                             .set("totals", totals)
                             .set("first", first)
                             .set("count", count)
                             .set("weighed", uint{rule.weighed})
                             .set("threshold", rule.threshold)
                             .set("max_level", max_level)
                             .set("split", split));
}

}  // namespace manylight

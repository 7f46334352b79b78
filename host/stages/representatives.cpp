// SPDX-License-Identifier: MIT
#include "stages/representatives.hpp"

namespace manylight {

RepresentativeStage::RepresentativeStage(Device& device)
    : pick_(device.kernel("representatives.cl", "representatives_pick", {}, "representatives")) {}

void RepresentativeStage::pick(const Tiles& tiles, const Buffer<Surface>& surfaces,
                               const Buffer<Region>& regions, uint first, uint count,
                               Buffer<uint>& representatives) {
    pick_.launch(count, Arguments()
                            .set("tiles", tiles)
                            .set("surfaces", surfaces)
                            .set("regions", regions)
                            .set("first", first)
                            .set("count", count)
                            .set("representatives", representatives));
}

}  // namespace manylight

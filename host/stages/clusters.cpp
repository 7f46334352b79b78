// SPDX-License-Identifier: MIT
#include "stages/clusters.hpp"

namespace manylight {

ClusterStage::ClusterStage(Device& device)
    : split_(device.kernel("clusters.cl", "clusters_split", {}, "clusters")),
      assign_(device.kernel("clusters.cl", "clusters_assign", {}, "clusters")) {}

void ClusterStage::split(const Tiles& tiles, const Buffer<Surface>& surfaces,
                         const Buffer<Region>& regions, uint count, float cos_threshold,
                         uint max_level, Buffer<uint>& split) {
    split_.launch(count, Arguments()
                             .set("tiles", tiles)
                             .set("regions", regions)
                             .set("region_count", count)
                             .set("surfaces", surfaces)
                             .set("cos_threshold", cos_threshold)
                             .set("max_level", max_level)
                             .set("split", split));
}

void ClusterStage::assign(const Tiles& tiles, const Buffer<Region>& regions, uint count,
                          const Buffer<uint>& split, Buffer<uint>& item_rows) {
    assign_.launch(count, Arguments()
                              .set("tiles", tiles)
                              .set("regions", regions)
                              .set("region_count", count)
                              .set("split", split)
                              .set("item_rows", item_rows));
}

}  // namespace manylight

// SPDX-License-Identifier: MIT
#include "samplers/contribution_cached/neighbours.hpp"

#include "shared/contribution_cached.h"

namespace manylight {

NeighbourStage::NeighbourStage(Device& device, unsigned most_tiles, unsigned regions)
    : find_(device.kernel("samplers/contribution_cached/neighbours.cl", "neighbours_find", {},
                          "neighbours")),
      clusters_(device.allocate<uint>(std::size_t{most_tiles} * regions)),
      tile_first_(device.allocate<uint>(std::size_t{most_tiles} + 1)),
      neighbours_(device.allocate<uint>(clusters_.size() * MOST_NEIGHBOURS)),
      places_(device.allocate<float4>(clusters_.size())) {}

void NeighbourStage::find(const Tiles& tiles, const Buffer<Surface>& surfaces,
                          const Clustering& clustering, float least_cosine) {
    const std::vector<Region>& regions = clustering.regions();
    const auto tile_of = [&](const Region& region) {
        return region.y / tiles.size * tiles.columns + region.x / tiles.size - tiles.first;
    };
    // Rows by tile: counted, then put in their order.
    std::vector<uint> first(tiles.count + 1);
    for (std::size_t row = 0; row < regions.size(); ++row)
        if (!clustering.split()[row]) ++first[tile_of(regions[row]) + 1];
    for (uint tile = 0; tile < tiles.count; ++tile) first[tile + 1] += first[tile];
    std::vector<uint> clusters(first.back());
    std::vector<uint> next = first;
    for (std::size_t row = 0; row < regions.size(); ++row)
        if (!clustering.split()[row])
            clusters[next[tile_of(regions[row])]++] = static_cast<uint>(row);
    clusters_.upload(clusters);
    tile_first_.upload(first);
    find_.launch(clusters.size(), Arguments(clustering.clusters())
                                      .set(tables())
                                      .set("tiles", tiles)
                                      .set("clusters", clusters_)
                                      .set("cluster_count", static_cast<uint>(clusters.size()))
                                      .set("tile_first", tile_first_)
                                      .set("surfaces", surfaces)
                                      .set("least_cosine", least_cosine));
}

Arguments NeighbourStage::tables() const {
    return Arguments().set("neighbours", neighbours_).set("places", places_);
}

std::size_t NeighbourStage::tile_bytes(unsigned regions) {
    return regions * ((1 + MOST_NEIGHBOURS) * sizeof(uint) + sizeof(float4)) + sizeof(uint);
}

}  // namespace manylight

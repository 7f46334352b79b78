// SPDX-License-Identifier: MIT
#pragma once

#include "samplers/contribution/clustering.hpp"

namespace manylight {

/// Stage neighbours: which clusters of a batch are near a cluster, and alike; see
/// kernels/samplers/contribution_cached/neighbours.cl.
class NeighbourStage {
  public:
    /// For up to `most_tiles` tiles of `regions` regions each.
    NeighbourStage(Device& device, unsigned most_tiles, unsigned regions);

    /// Finds the neighbours of all clusters, whose normals have `least_cosine` between them.
    /// `surfaces`: those that were clustered.
    void find(const Tiles& tiles, const Buffer<Surface>& surfaces, const Clustering& clustering,
              float least_cosine);

    /// The buffers that the sampler draws from: neighbours, places.
    [[nodiscard]] Arguments tables() const;

    /// Bytes per tile on the device.
    [[nodiscard]] static std::size_t tile_bytes(unsigned regions);

  private:
    Kernel find_;
    Buffer<uint> clusters_;    // [tile_first_[tile] and on] rows
    Buffer<uint> tile_first_;  // [tile, and one after the last]
    Buffer<uint> neighbours_;  // [MOST_NEIGHBOURS * row + i]
    Buffer<float4> places_;    // [row]
};

}  // namespace manylight

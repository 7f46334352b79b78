// SPDX-License-Identifier: MIT
#pragma once

#include "device/device.hpp"
#include "shared/surface.h"
#include "stages/tiles.hpp"

namespace manylight {

/// Stage clusters: each tile's quadtree by corner normals (paper 4.1).
class ClusterStage {
  public:
    explicit ClusterStage(Device& device);

    /// split[region]: 1 where the region is to be split: two of its corner pixels' normals have a
    /// cosine below `cos_threshold` or only one of them hit the scene, and its level is below
    /// `max_level`. `regions` and `split` hold at least `count` elements.
    void split(const Tiles& tiles, const Buffer<Surface>& surfaces, const Buffer<Region>& regions,
               uint count, float cos_threshold, uint max_level, Buffer<uint>& split);

    /// item_rows[item]: the region without split mark that the item's pixel lies in.
    void assign(const Tiles& tiles, const Buffer<Region>& regions, uint count,
                const Buffer<uint>& split, Buffer<uint>& item_rows);

  private:
    Kernel split_;
    Kernel assign_;
};

}  // namespace manylight

// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>

#include "samplers/adaptive/cuts.hpp"

namespace manylight {

/// What shadow rays have said about the nodes of a batch's cuts, by cells of 4 x 4 pixels; layout
/// in shared/adaptive.h.
struct Visibility {
    /// For `tiles` tiles, of which up to `in_work` have estimates.
    Visibility(Device& device, std::size_t lights, std::size_t tiles, std::size_t in_work);

    Buffer<uint> counts;    // over slots and cells: rays traced + 65536 rays passed
    Buffer<Trials> totals;  // [tile * CUT_CAPACITY + slot]: of the tile, probes included
    Buffer<Trials> shared;  // likewise, with what neighbouring tiles lend
    Buffer<float> visible;  // over slots and cells: V^ of the tiles that were estimated last

    /// As kernels' arguments counts, totals, shared, visible.
    [[nodiscard]] Arguments arguments() const;

    /// Slots of a tile.
    [[nodiscard]] static constexpr std::size_t slots(std::size_t lights) {
        return std::min<std::size_t>(lights, CUT_CAPACITY);
    }
    /// Bytes on the device of a tile, and more while it is in work.
    [[nodiscard]] static constexpr std::size_t tile_bytes(std::size_t lights) {
        return slots(lights) * CELLS_PER_TILE * sizeof(uint) + CUT_CAPACITY * 2 * sizeof(Trials);
    }
    [[nodiscard]] static constexpr std::size_t work_bytes(std::size_t lights) {
        return slots(lights) * CELLS_PER_TILE * sizeof(float);
    }
};

/// Stage visibility: counts shadow rays, and estimates V^ from the counts, shrunk from level to
/// level: all slots of a tile (and some of what its neighbours know), eight neighbours, the slot,
/// then 16 x 16, 8 x 8 and 4 x 4 pixels.
class VisibilityStage {
  public:
    VisibilityStage(Device& device, const DeviceScene& scene);

    /// Adds what stage shadows found for the rays of a pass (the arguments drawn and rays).
    void learn(const Pass& pass, const Arguments& draws, Visibility& out);

    /// Sums up what is known of every tile, and shares it with neighbours.
    void sum(const Tiles& tiles, const Cuts& cuts, Visibility& out);

    /// Estimates V^ of `count` tiles of the batch from `first` on, since the last sum().
    void estimate(uint first, uint count, const Cuts& cuts, Visibility& out);

  private:
    Arguments scene_;
    unsigned lanes_;
    Kernel learn_;
    Kernel sum_;
    Kernel share_;
    Kernel estimate_;
};

}  // namespace manylight

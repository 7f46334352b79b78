// SPDX-License-Identifier: MIT
#pragma once

#include "stages/cuts.hpp"

namespace manylight {

/// What shadow rays have said about the nodes of a batch's cuts, by cells of 4 x 4 pixels; layout
/// in shared/adaptive.h.
struct Visibility {
    Visibility(Device& device, std::size_t tiles);

    Buffer<uint> counts;    // over slots and cells: rays traced + 65536 rays passed
    Buffer<Trials> totals;  // [tile * CUT_CAPACITY + slot]: of the tile, probes included
    Buffer<Trials> shared;  // likewise, with what neighbouring tiles lend
    Buffer<float> visible;  // over slots and cells: the estimated visibility V^

    /// As kernels' arguments counts, totals, shared, visible.
    [[nodiscard]] Arguments arguments() const;

    [[nodiscard]] static constexpr std::size_t tile_bytes() {
        return CUT_CAPACITY *
               (CELLS_PER_TILE * (sizeof(uint) + sizeof(float)) + 2 * sizeof(Trials));
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

    /// Renews the estimates.
    void estimate(const Tiles& tiles, const Cuts& cuts, Visibility& out);

  private:
    Arguments scene_;
    Kernel learn_;
    Kernel sum_;
    Kernel share_;
    Kernel estimate_;
};

}  // namespace manylight

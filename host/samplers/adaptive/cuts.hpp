// SPDX-License-Identifier: MIT
#pragma once

#include "shared/adaptive.h"
#include "shared/surface.h"
#include "stages/device_scene.hpp"
#include "stages/tiles.hpp"

namespace manylight {

/// The cuts of a batch of tiles; [tile * CUT_CAPACITY + slot].
struct Cuts {
    Cuts(Device& device, std::size_t tiles);

    Buffer<uint> nodes;     // in the light trees, in their order
    Buffer<uint> sizes;     // [tile], 0 where nothing is hit
    Buffer<Trials> probes;  // what shadow rays from representatives said

    /// As kernels' arguments cut_nodes, cut_sizes, probes.
    [[nodiscard]] Arguments arguments() const;

    [[nodiscard]] static constexpr std::size_t tile_bytes() {
        return CUT_CAPACITY * (sizeof(uint) + sizeof(Trials)) + sizeof(uint);
    }
};

struct CutOptions {
    uint size;        // nodes at most, up to CUT_CAPACITY
    uint probe_rays;  // per node
    uint seed;
};

/// Stage cuts: for each tile the nodes of the light trees that its pixels choose from, and first
/// shadow rays to them. From the roots on, the node with the largest estimated contribution
/// (averaged over representative pixels) times the root of its visibility is split.
class CutStage {
  public:
    /// `scene` was uploaded with its light trees.
    CutStage(Device& device, const DeviceScene& scene);

    void make(const Tiles& tiles, const Buffer<Surface>& surfaces, const CutOptions& options,
              Cuts& cuts);

  private:
    Arguments scene_;
    Kernel make_;
};

}  // namespace manylight

// SPDX-License-Identifier: MIT
#pragma once

#include "stages/samples.hpp"
#include "stages/visibility.hpp"

namespace manylight {

/// Pixels of a pass over `tiles` tiles.
[[nodiscard]] inline std::size_t pass_pixels(const Pass& pass) {
    return std::size_t{pass.tile_count} * CELLS_PER_TILE * pass.count;
}

/// Stage samples of sampler adaptive: draws nodes of the tile's cut for every pixel of a pass, then
/// a light of each; shadow rays correct what the nodes' estimates times V^ got wrong.
class AdaptiveStage {
  public:
    /// For launches with up to `packets` packets of draws, and passes of up to `pixels` pixels of a
    /// batch.
    AdaptiveStage(Device& device, const DeviceScene& scene, std::size_t packets,
                  std::size_t pixels);

    /// Estimates the pixels of a pass. What they come to, times `weight`, is added to the
    /// estimates, or starts them.
    void draw(const Tiles& tiles, const Pass& pass, const Budget& budget, const PixelSample& sample,
              const Buffer<Surface>& surfaces, const Cuts& cuts, const Visibility& visibility,
              float weight, bool start, Estimates& estimates);

    /// What the last draw() did: the buffers drawn, shares, base, rays, values as kernels'
    /// arguments.
    [[nodiscard]] Arguments draws() const;

    /// What the pixels of all launches of a pass over the batch were expected to be like, in the
    /// order of their cells and places.
    [[nodiscard]] std::vector<Expectation> expectations(std::size_t pixels) const {
        return expectations_.download(0, pixels);
    }

    // Of the last draw(); see kernels/samplers/adaptive.cl.
    [[nodiscard]] const Buffer<uint>& drawn() const { return drawn_; }
    [[nodiscard]] const Buffer<float>& shares() const { return shares_; }
    [[nodiscard]] const Buffer<float>& rays() const { return shadows_.rays(); }

    [[nodiscard]] static constexpr std::size_t packet_bytes() {
        return ShadowStage::packet_bytes() + (48 + 2 * 16 + 4) * sizeof(float);
    }

  private:
    Arguments scene_;
    bool reflections_;
    ShadowStage shadows_;
    Kernel draw_;
    Kernel aim_;
    Kernel add_;
    Buffer<uint> drawn_;
    Buffer<float> shares_;
    Buffer<float4> base_;
    Buffer<float> values_;
    Buffer<Expectation> expectations_;
};

}  // namespace manylight

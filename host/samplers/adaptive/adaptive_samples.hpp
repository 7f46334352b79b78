// SPDX-License-Identifier: MIT
#pragma once

#include "samplers/adaptive/visibility.hpp"
#include "stages/samples.hpp"

namespace manylight {

/// A node that a pixel drew.
struct DrawnNode {
    uint node, slot;
    float share;  // how often the pixel draws it on average
    float end;    // of its shadow ray: positive where it passed, negative where not, 0 without one
};

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

    /// Pixels that are drawn together: they share what is refined.
    [[nodiscard]] unsigned lanes() const { return lanes_; }

    /// What the last draw() did, as kernels' arguments (kernels/lib/cells.h).
    [[nodiscard]] Arguments draws() const;

    /// What the pixels of all launches of a pass over the batch were expected to be like, in the
    /// order of their cells and places.
    [[nodiscard]] std::vector<Expectation> expectations(std::size_t pixels) const {
        return expectations_.download(0, pixels);
    }

    /// What each pixel of the pass of the last draw() drew.
    [[nodiscard]] std::vector<std::vector<DrawnNode>> drawn(const Pass& pass) const;

    /// Bytes of a packet on the device, at most: pixels that are drawn together share two counts.
    [[nodiscard]] static constexpr std::size_t packet_bytes() {
        return ShadowStage::packet_bytes() + (64 + 48 + 2 + 3 + 2) * sizeof(float);
    }

  private:
    Arguments scene_;
    unsigned lanes_;  // pixels that are drawn together
    ShadowStage shadows_;
    Kernel draw_;
    Kernel aim_;
    Kernel add_;
    Buffer<uint> draws_;
    Buffer<uint> draw_counts_;
    Buffer<uint> pixel_packets_;
    Buffer<uint> packet_counts_;
    Buffer<float> base_;
    Buffer<float> values_;
    Buffer<Expectation> expectations_;
};

}  // namespace manylight

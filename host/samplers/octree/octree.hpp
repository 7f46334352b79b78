// SPDX-License-Identifier: MIT
#pragma once

#include "samplers/sampler.hpp"
#include "shared/octree.h"

namespace manylight {

/// Sampler octree: for each pixel sample the nodes of an octree of lights that are as good as one
/// light there, with a shadow ray to one of the lights of each, or to its virtual light.
class Octree : public LightSampler {
  public:
    /// `to_virtual`: rays go to virtual lights.
    Octree(const SamplerContext& context, bool to_virtual);

    bool draw(const Tiles& tiles, const PixelSample& sample, uint light_samples,
              const Buffer<Surface>& surfaces, Estimates& estimates, const Sink& sink) override;

    [[nodiscard]] const std::vector<OctreeNode>& nodes() const { return nodes_; }
    [[nodiscard]] float epsilon() const { return epsilon_; }
    [[nodiscard]] bool to_virtual() const { return to_virtual_; }

    [[nodiscard]] static Footprint footprint(const SamplerLoad& load);

  private:
    // The share of the nodes that all pixels together have passed.
    [[nodiscard]] double share_done(std::size_t items) const;

    float epsilon_;
    bool to_virtual_;
    std::vector<OctreeNode> nodes_;
    Arguments scene_;
    ShadowStage shadows_;
    Kernel draw_;
    Kernel add_;
    Buffer<OctreeNode> device_nodes_;
    Buffer<uint> next_nodes_;  // [item] where its cut goes on
    Buffer<float4> totals_;    // [item] what errors are relative to, cd/m2
    Buffer<float> values_;     // [48 * item + 16 * channel + lane], see kernels/lib/samples.h
};

}  // namespace manylight

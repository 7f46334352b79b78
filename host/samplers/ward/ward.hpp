// SPDX-License-Identifier: MIT
#pragma once

#include "samplers/sampler.hpp"

namespace manylight {

/// Lights that the samplers take at most: all of them are evaluated at every pixel sample.
constexpr std::size_t most_ward_lights = std::size_t{1} << 15;

/// The parameters of samplers ward and ward-unbiased.
[[nodiscard]] std::vector<Parameter> ward_parameters();

/// Sampler ward (Ward, "Adaptive Shadow Testing for Ray Tracing", 1991): at every pixel sample all
/// lights are evaluated without shadows and tested in descending order, until those left cannot
/// matter much; these are added by how often they were seen from the tile. Light samples do not
/// count: it takes as many rays as it needs.
class Ward : public LightSampler {
  public:
    explicit Ward(const SamplerContext& context);

    /// Probes every light from every tile.
    void begin(const Tiles& tiles, const Buffer<Surface>& surfaces, uint seed,
               const RayCount& progress) override;
    [[nodiscard]] double expected_begin_rays(const Tiles& tiles) const override;
    [[nodiscard]] std::size_t begin_rays() const override;

    bool draw(const Tiles& tiles, const PixelSample& sample, uint light_samples,
              const Buffer<Surface>& surfaces, Estimates& estimates, const Sink& sink) override;

    void save(FrameState& state) override;
    void resume(const Tiles& tiles, const Buffer<Surface>& surfaces, uint seed,
                const FrameState& state, const RayCount& progress) override;

    /// The tiles of the last batch, and their hit histories (kernels/shared/ward.h), [tile * lights
    /// + light].
    [[nodiscard]] const Tiles& tiles() const { return tiles_; }
    [[nodiscard]] std::vector<uint> histories() const;

    [[nodiscard]] double tau() const { return tau_; }
    [[nodiscard]] double certainty() const { return certainty_; }

    [[nodiscard]] static Footprint footprint(const SamplerLoad& load);

  protected:
    /// Items of a slice at most.
    [[nodiscard]] std::size_t slots() const { return slots_; }
    [[nodiscard]] static std::size_t slots_of(const SamplerLoad& load);

    [[nodiscard]] ShadowStage& shadows() { return shadows_; }

    /// Corrects the estimates of a slice of a batch, `slots` items, by light samples of what was
    /// left; `arguments` hold all that the kernels of a slice take.
    virtual void draw_tail(std::size_t /*slots*/, const PixelSample& /*sample*/,
                           uint /*light_samples*/, Arguments& /*arguments*/) {}

  private:
    void walk(std::size_t slots, const PixelSample& sample, const Arguments& arguments);

    Arguments scene_;
    uint light_count_;
    std::size_t slots_;
    double tau_;
    double certainty_;
    Tiles tiles_{};
    ShadowStage shadows_;
    Kernel probe_;
    Kernel weigh_;
    Kernel step_;
    Kernel tail_;
    Buffer<uint> histories_;
    // Over the slots, see kernels/samplers/ward/walk.h.
    Buffer<float4> contributions_;
    Buffer<uint> order_;
    Buffer<float4> walks_;
    Buffer<uint> counts_;
};

}  // namespace manylight

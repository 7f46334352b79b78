// SPDX-License-Identifier: MIT
#pragma once

#include "samplers/adaptive/adaptive_samples.hpp"
#include "samplers/adaptive/seen_lights.hpp"
#include "samplers/sampler.hpp"

namespace manylight {

/// What sampler adaptive knows of a tile, and how it would draw a pixel sample's next pass.
struct TileKnowledge {
    std::vector<uint> cut;       // [slot] node of the light tree
    std::vector<float> visible;  // [64 * slot + cell] V^ (negative: see kernels/shared/adaptive.h),
                                 // cells in Morton order
    Budget budget;               // of one round
    uint rounds;                 // of draws, whose mean is taken
    unsigned together;           // pixels that share what is refined
};

/// Sampler adaptive on a batch of tiles: pixels in interleaved passes, each of which learns from
/// the shadow rays of those before it.
class Adaptive : public LightSampler {
  public:
    explicit Adaptive(const SamplerContext& context);

    /// Where a node of a cut may hold lights that are seen beside others, and there are not too
    /// many lights for the image.
    [[nodiscard]] std::vector<bool> find_seen_lights(uint seed) override;

    /// Cuts the light trees for tiles, from their first surfaces.
    void begin(const Tiles& tiles, const Buffer<Surface>& surfaces, uint seed,
               const RayCount& progress) override;

    bool draw(const Tiles& tiles, const PixelSample& sample, uint light_samples,
              const Buffer<Surface>& surfaces, Estimates& estimates, const Sink& sink) override;

    void save(FrameState& state) override;
    void resume(const Tiles& tiles, const Buffer<Surface>& surfaces, uint seed,
                const FrameState& state, const RayCount& progress) override;

    /// What is known of a tile of the batch, after draw().
    [[nodiscard]] TileKnowledge knowledge(uint tile);

    [[nodiscard]] static Footprint footprint(const SamplerLoad& load);

  private:
    bool pass_over(const Tiles& tiles, Pass pass, const PixelSample& sample, uint light_samples,
                   const Buffer<Surface>& surfaces, Estimates& estimates, const Sink& sink);
    static std::size_t packets_for(std::size_t tiles, uint light_samples);
    void sum_up();
    void set_budget(const std::vector<Expectation>& pixels);

    static constexpr uint most_places = 8;     // of a cell in one pass
    static constexpr uint most_in_work = 512;  // tiles, whose V^ is held

    std::optional<SeenLightsStage> seen_lights_stage_;
    CutStage cut_stage_;
    VisibilityStage visibility_stage_;
    AdaptiveStage adaptive_stage_;
    Cuts cuts_;
    Visibility visibility_;
    uint light_count_;
    unsigned width_;
    uint light_samples_ = 1;  // of the last draw
    Tiles tiles_{};           // of the batch
    bool fresh_ = true;       // nothing was learned yet
    bool is_summed_ = false;
    std::size_t drawn_pixels_ = 0;  // of the last pass
    float factor_ = 0;              // see Budget; for one draw on average
    float exposure_ = 0;
};

}  // namespace manylight

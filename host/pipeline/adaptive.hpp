// SPDX-License-Identifier: MIT
#pragma once

#include <functional>

#include "pipeline/checkpoint.hpp"
#include "stages/adaptive.hpp"

namespace manylight {

/// What sampler adaptive knows of a tile, and how it would draw a pixel sample's next pass.
struct TileKnowledge {
    std::vector<uint> cut;       // [slot] node of the light tree
    std::vector<float> visible;  // [64 * slot + cell] V^, cells in Morton order
    Budget budget;               // of one round
    uint rounds;                 // of draws, whose mean is taken
    unsigned together;           // pixels that share what is refined
};

/// Sampler adaptive on a batch of tiles: pixels in interleaved passes, each of which learns from
/// the shadow rays of those before it.
class Adaptive {
  public:
    /// Holds up to `most_tiles` tiles. `width`: of the image, pixels.
    Adaptive(Device& device, const DeviceScene& scene, unsigned most_tiles, unsigned width,
             uint most_light_samples);

    /// Cuts the light trees for tiles, from their first surfaces; forgets what was learned.
    void start(const Tiles& tiles, const Buffer<Surface>& surfaces, uint seed);

    /// Fills the estimates of one sample of every pixel, some pixels after others: `done` is called
    /// whenever those of a pass are there, and says whether to go on.
    void draw(const Tiles& tiles, const PixelSample& sample, uint light_samples,
              const Buffer<Surface>& surfaces, Estimates& estimates,
              const std::function<bool(const Pass&)>& done);

    /// Puts what it takes to go on with the batch between two pixel samples.
    void save(FrameState& state);
    /// Goes on where save() was called, in place of start().
    void resume(const Tiles& tiles, const FrameState& state);

    /// What is known of a tile of the batch, after draw().
    [[nodiscard]] TileKnowledge knowledge(uint tile);

    /// Bytes on the device for each tile, and besides.
    [[nodiscard]] static constexpr std::size_t tile_bytes(std::size_t lights) {
        return Cuts::tile_bytes() + Visibility::tile_bytes(lights) +
               CELLS_PER_TILE * most_places * sizeof(Expectation);
    }
    [[nodiscard]] static std::size_t fixed_bytes(std::size_t lights, std::size_t tiles,
                                                 uint light_samples) {
        return packets_for(tiles, light_samples) * AdaptiveStage::packet_bytes() +
               std::min<std::size_t>(tiles, most_in_work) * Visibility::work_bytes(lights);
    }

  private:
    bool pass_over(const Tiles& tiles, Pass pass, const PixelSample& sample, uint light_samples,
                   const Buffer<Surface>& surfaces, Estimates& estimates,
                   const std::function<bool(const Pass&)>& done);
    static std::size_t packets_for(std::size_t tiles, uint light_samples);
    void sum_up();
    void set_budget(const std::vector<Expectation>& pixels);

    static constexpr uint most_places = 8;     // of a cell in one pass
    static constexpr uint most_in_work = 512;  // tiles, whose V^ is held

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

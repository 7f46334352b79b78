// SPDX-License-Identifier: MIT
// What a sampler is to everything else: a row of the table, and what runs.
#pragma once

#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include "output/checkpoint.hpp"
#include "samplers/contribution/options.hpp"
#include "samplers/parameters.hpp"
#include "stages/samples.hpp"

namespace manylight {

/// What a sampler is made for. There are lights.
struct SamplerContext {
    Device& device;
    const DeviceScene& scene;  // its lights in the tree's order, where the row asks for a tree
    const std::vector<Light>& lights;
    unsigned tiles;      // of a batch, at most
    unsigned tile_size;  // pixels of a side
    unsigned width;      // of the image, pixels
    uint light_samples;  // of a pixel sample, at most
    ClusterOptions clusters;
    ParameterValues parameters;  // of all that the row has

    /// Of a batch, at most.
    [[nodiscard]] std::size_t items() const { return std::size_t{tiles} * tile_size * tile_size; }
    [[nodiscard]] double parameter(std::string_view name) const {
        return parameters.find(name)->second;
    }
};

/// Bytes that a sampler takes on the device, at any one time: all that make(), prepare(), begin()
/// and draw() allocate. Tests of frames fail where more is allocated.
struct Footprint {
    std::size_t fixed = 0;        // rays in work and the like
    std::size_t image = 0;        // tables of the whole image
    std::size_t tile = 0;         // of each tile of a batch
    std::size_t tile_buffer = 0;  // the part of `tile` that is in one buffer, at most
    std::size_t tile_matrix = 0;  // the part of `tile` that is contributions and CDFs
};

/// What a footprint depends on. There are lights.
struct SamplerLoad {
    uint lights;
    std::size_t tiles;  // of a batch, at most
    unsigned tile_size;
    uint light_samples;  // of a pixel sample, at most
    const ClusterOptions& clusters;
    const ParameterValues& parameters;  // of all that the row has

    [[nodiscard]] std::size_t tile_items() const { return std::size_t{tile_size} * tile_size; }
    [[nodiscard]] double parameter(std::string_view name) const {
        return parameters.find(name)->second;
    }
};

/// The clusters of a batch, on the host.
struct ClusterFacts {
    std::vector<uint> rows;             // [item] region
    std::vector<uint> representatives;  // [region] item
    std::vector<RowSum> totals;         // [region]
    std::vector<uint> split;            // [region] 1 where it is none but its quarters are
};

/// Is told the shadow rays that were traced since the last time.
using RayCount = std::function<void(std::size_t)>;

/// Is called whenever light samples are done, with their number over all pixels and the pass of
/// pixels that have all of theirs, if pixels are finished by passes. Says whether to go on.
using Sink = std::function<bool(const std::optional<Pass>& finished, std::size_t samples)>;

/// A sampler at work on one batch of tiles after another. What is called has lights to draw.
class LightSampler {
  public:
    LightSampler() = default;
    LightSampler(const LightSampler&) = delete;
    LightSampler& operator=(const LightSampler&) = delete;
    virtual ~LightSampler() = default;

    /// A first look at the lights, in the scene's order and before prepare(): [light] whether
    /// anything in the image sees it, for the light tree. Empty: no such difference is made.
    [[nodiscard]] virtual std::vector<bool> find_seen_lights(uint /*seed*/) { return {}; }

    /// Makes what the whole image needs; its kernels are compiled.
    virtual void prepare() {}

    /// How many shadow rays begin() will take, about.
    [[nodiscard]] virtual double expected_begin_rays(const Tiles& /*tiles*/) const { return 0; }

    /// Makes what a batch needs, and forgets the one before. `surfaces`: at the pixels' centres
    /// where the row clusters, else the first pixel samples'.
    virtual void begin(const Tiles& /*tiles*/, const Buffer<Surface>& /*surfaces*/, uint /*seed*/,
                       const RayCount& /*progress*/) {}

    /// Fills the estimates of one sample of every pixel of the batch. Returns false where `sink`
    /// stopped it before all were done.
    virtual bool draw(const Tiles& tiles, const PixelSample& sample, uint light_samples,
                      const Buffer<Surface>& surfaces, Estimates& estimates, const Sink& sink) = 0;

    /// Puts what it takes to go on with the batch between two pixel samples.
    virtual void save(FrameState& /*state*/) {}
    /// Goes on where save() was called, in place of begin().
    virtual void resume(const Tiles& tiles, const Buffer<Surface>& surfaces, uint seed,
                        const FrameState& /*state*/, const RayCount& progress) {
        begin(tiles, surfaces, seed, progress);
    }

    /// The buffers that kernels of the row's file draw lights from, by their names there; what is
    /// in them, since the last begin().
    [[nodiscard]] virtual const Arguments& tables() const {
        static const Arguments none;
        return none;
    }

    // What the last begin() made.
    [[nodiscard]] virtual std::size_t begin_rays() const { return 0; }  // shadow rays that it took
    [[nodiscard]] virtual std::size_t cluster_count() const { return 0; }
    [[nodiscard]] virtual ClusterFacts cluster_facts() const { return {}; }
};

/// A row of the table of samplers.
struct Sampler {
    std::string_view name;
    std::string_view summary;  // one line for help
    std::string_view color;    // in plots of many charts, #rrggbb
    bool biased = false;
    bool all_lights = false;     // light sample i is light i
    bool own_rays = false;       // takes as many as it needs, whatever the number of light samples
    bool tree = false;           // needs the light tree
    bool clusters = false;       // clusters pixels, from surfaces at their centres
    bool large_batches = false;  // as large as may be: what is made of one is of all its tiles
    unsigned tile_size = 0;      // pixels of a tile's side; 0: as the options say
    std::size_t most_lights = std::numeric_limits<std::size_t>::max();
    std::vector<Parameter> parameters = {};
    // The kernel file that has light_probability(), for the shares of stage reflections (see
    // kernels/lib/reflected.h); none where a light sample's probability has no closed form: there
    // one light sample on each cell of an area light is taken for what it is.
    std::string_view closed_form = {};
    Footprint (*footprint)(const SamplerLoad& load) = nullptr;
    std::unique_ptr<LightSampler> (*make)(const SamplerContext& context) = nullptr;
};

}  // namespace manylight

// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <functional>
#include <optional>

#include "bvh/wide.hpp"
#include "clock.hpp"
#include "samplers/contribution/options.hpp"
#include "samplers/parameters.hpp"
#include "stages/emitter_parts.hpp"

namespace manylight {

struct RenderOptions {
    std::string sampler = "adaptive";
    uint light_samples = 0;   // per pixel sample, see samples_of(); exhaustive takes all lights
    uint spp = 4;             // pixel samples, at most
    uint begun_spp = 0;       // likewise, of the render that this one goes on with, if any
    double target_error = 0;  // stop where relMSE is no more, by its interval's end; 0: at spp
    std::optional<Clock::time_point> deadline;  // stop by then, but for one sample of each pixel
    std::function<bool()> interrupted;          // stop as soon as may be, once it returns true
    uint seed = 0;
    unsigned width = 512;
    unsigned height = 512;
    bool pixel_centre = false;   // all pixel samples at the pixel's centre; always with spp 1
    bool hide_emitters = false;  // emitters give light but are black
    bool reflections = true;     // false: all by light samples, without stage reflections
    ClusterOptions clusters;
    ParameterValues parameters;  // of the sampler, as far as they were set
    std::size_t memory = 0;      // bytes on the device; 0: half of it, at most 2 GiB
    std::vector<std::string> aovs;

    static constexpr uint first_samples = 4;

    /// Light samples of pixel sample i: as given, or 4 in the first four, then 16. Weights at a
    /// pixel are evaluated once per pixel sample, whatever the number of its light samples.
    [[nodiscard]] uint samples_of(uint i) const {
        return light_samples > 0 ? light_samples : (i < first_samples ? 4u : 16u);
    }
    [[nodiscard]] uint most_samples() const { return samples_of(planned_spp() - 1); }

    [[nodiscard]] uint planned_spp() const { return std::max(spp, begun_spp); }

    /// Whether the error is estimated.
    [[nodiscard]] bool estimates_error() const;

    /// Side of a tile in pixels: the sampler's, or clusters.tile_size where the sampler has none.
    [[nodiscard]] unsigned tile_size() const;

    /// Whether pixel samples lie at random in their pixels.
    [[nodiscard]] bool jitters() const { return planned_spp() > 1 && !pixel_centre; }

    /// What stage emitter_parts draws; nothing where pixels are seen at their centres.
    [[nodiscard]] EmitterParts emitter_parts(const Scene& scene, const Camera& camera) const;
};

/// What a frame will take on the device, bytes.
struct Plan {
    std::size_t scene_bytes = 0;
    std::size_t image_bytes = 0;
    std::size_t batch_bytes = 0;    // of all buffers of a batch of tiles, and the sampler's
    std::size_t point_bytes = 0;    // of these: materials of the batch's points
    std::size_t sampler_bytes = 0;  // of these: the sampler's
    std::size_t matrix_bytes = 0;   // of these: contributions, CDFs, other tables of the image
    unsigned batches = 0;
    unsigned tiles_per_batch = 0;
    bool clusters = false;  // whether pixels are clustered
    bool centres = false;   // whether a G-buffer at the pixels' centres is kept

    [[nodiscard]] std::size_t total_bytes() const {
        return scene_bytes + image_bytes + batch_bytes;
    }
};

/// As many tiles in a batch as the budget and the device allow, each with its quadtree at its
/// worst. `emitters`: options.emitter_parts(). Throws InputError where the options contradict
/// each other or not even one tile fits.
[[nodiscard]] Plan make_plan(const DeviceInfo& device, const Scene& scene, const WideBvh& bvh,
                             const RenderOptions& options, const EmitterParts& emitters = {});

}  // namespace manylight

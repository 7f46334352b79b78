// SPDX-License-Identifier: MIT
// What of a frame is saved and resumed; how it lies in a file: output/checkpoint.hpp.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "output/checkpoint.hpp"
#include "pipeline/plan.hpp"
#include "samplers/sampler.hpp"
#include "stages/accumulate.hpp"

namespace manylight {

/// How far a frame is.
struct Standing {
    std::vector<uint> done;        // [batch] pixel samples begun
    std::uint64_t begin_rays = 0;  // shadow rays that batches began with
    std::uint64_t primary_rays = 0;
};

/// Saves a frame between two pixel samples of a batch, now and then, and resumes one.
class Checkpoints {
  public:
    /// `options` live longer.
    Checkpoints(const RenderOptions& options, const Plan& plan)
        : options_(options), batches_(plan.batches) {}

    /// Goes on with `state`, if there is one: restores how far it was, and the image so far. Throws
    /// InputError for more pixel samples than it can go on to.
    void start(const Saving& saving, const FrameState* state, Standing& standing, ImageSum& image);

    [[nodiscard]] bool is_resumed() const { return is_resumed_; }
    /// Pixel samples that the resumed render was on the way to, or 0.
    [[nodiscard]] uint resumed_end() const { return resumed_end_; }
    /// What a batch goes on with; null where it is to be begun.
    [[nodiscard]] const FrameState* state_of(unsigned batch) const;
    /// The render has gone on with it.
    void drop_state() { state_ = nullptr; }

    /// Whether states are saved at all, and whether it is time to.
    [[nodiscard]] bool are_saved() const { return static_cast<bool>(saving_.save); }
    [[nodiscard]] bool is_due() const { return seconds_since(saved_) > saving_.seconds; }

    /// Saves, within or after `batch` on the way to `end` pixel samples. `sampler`: that has work
    /// to go on with, or null.
    void save(unsigned batch, uint end, const Standing& standing, const ImageSum& image,
              LightSampler* sampler);

  private:
    const RenderOptions& options_;
    unsigned batches_;
    Saving saving_;
    Clock::time_point saved_;
    const FrameState* state_ = nullptr;  // until the render has gone on with it
    uint resumed_end_ = 0;
    bool is_resumed_ = false;
};

/// Names what is rendered, with everything that a pixel sample depends on but their number.
[[nodiscard]] std::string name_of_render(const Device& device, const Scene& scene,
                                         const Camera& camera, const RenderOptions& options,
                                         const Plan& plan);

}  // namespace manylight

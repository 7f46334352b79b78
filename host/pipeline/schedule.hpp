// SPDX-License-Identifier: MIT
// Which samples a frame takes, and when: rounds over the image, in each of them a visit of every
// batch, in each of these pixel samples.
#pragma once

#include <optional>

#include "output/error_estimate.hpp"
#include "pipeline/plan.hpp"
#include "samplers/sampler.hpp"
#include "stages/gbuffer.hpp"

namespace manylight {

/// Brings every pixel of the image to as many samples.
struct Round {
    uint end;          // samples of each pixel then
    double shown = 0;  // of the progress bar, before it
    double share = 1;  // of the progress bar, its own
};

/// Brings the pixels of a batch there.
struct Visit {
    unsigned number;  // of the batch
    Tiles batch;
    uint first, end;  // samples that they have, and are to have
    Clock::time_point begun;
    std::optional<Clock::time_point> deadline;
    double shown, share;  // as a round's
};

class Schedule {
  public:
    /// `options` live longer. `lights`: that each pixel sample's light samples are of.
    Schedule(const RenderOptions& options, const Plan& plan, std::size_t lights);

    /// Light samples of pixel sample i. A sampler to whose rays they hardly matter has as many of
    /// every pixel sample, so that all count alike.
    [[nodiscard]] uint light_samples(uint i) const;

    /// How much pixel sample i counts: by its light samples, and alike where there are no lights.
    [[nodiscard]] float weight(uint i) const;

    /// Where pixel sample i draws its light samples from.
    [[nodiscard]] PixelSample sample(uint i) const;

    /// Where it lies in its pixel, and draws its reflections from. These are stratified over
    /// samples. What the error is estimated from has to be independent: the even and the odd
    /// samples then have such a sequence each.
    [[nodiscard]] PixelSample position(uint i) const;

    /// The first round of a render that was already on the way to `resumed_end` samples, or 0: all
    /// samples, unless it is the error that ends the render.
    [[nodiscard]] Round first_round(uint resumed_end) const;

    /// The round after one, as long as the error so far says is needed; none: the image is done, or
    /// it is late.
    [[nodiscard]] std::optional<Round> next_round(const Round& round,
                                                  const std::optional<ErrorEstimate>& error) const;

    /// The visit of a batch whose pixels have `done` samples; `shown` of the progress bar, before.
    [[nodiscard]] Visit visit(const Round& round, unsigned batch, uint done, double shown) const;

    /// The share of the progress bar when `rays` of the visit are done, those of the batch's
    /// beginning first, of which `begin_rays` are expected.
    [[nodiscard]] double progress(const Visit& visit, double begin_rays, double rays) const;

  private:
    const RenderOptions& options_;
    Tiles all_;  // of the image
    unsigned batches_;
    unsigned tiles_per_batch_;
    uint lights_;
    const Sampler& sampler_;
};

/// Keeps a visit to its time.
class Pace {
  public:
    explicit Pace(const Visit& visit) : deadline_(visit.deadline) {}

    /// Whether pixel sample i is to be begun, with that many light samples. The very first one is,
    /// whatever the time; others while at least half of one fits, or any, where they can be cut
    /// short.
    [[nodiscard]] bool has_time(uint i, uint light_samples) const;

    /// Whether it is to go on.
    [[nodiscard]] bool goes_on(uint i) const;

    /// Times a pixel sample. `by_passes`: it finishes some pixels after others, and can be cut
    /// short in between.
    void begin() { begun_ = Clock::now(); }
    void set_by_passes(bool by_passes) { by_passes_ = by_passes; }
    [[nodiscard]] bool by_passes() const { return by_passes_; }
    void end(uint light_samples);

  private:
    [[nodiscard]] bool may_stop(uint i) const { return deadline_.has_value() && i > 0; }
    [[nodiscard]] double seconds_left() const;

    std::optional<Clock::time_point> deadline_;
    Clock::time_point begun_;
    double seconds_ = 0;  // of a light sample of all pixels
    bool by_passes_ = false;
};

}  // namespace manylight

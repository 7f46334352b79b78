// SPDX-License-Identifier: MIT
// Samplers ward and ward-unbiased: what kernels/samplers/ward/ computes.
#pragma once

#include <utility>
#include <vector>

#include "reference/samples.hpp"

namespace manylight::reference {

struct WardOptions {
    double tau;
    double certainty;
    bool draws_tail;              // ward-unbiased
    std::size_t tile_pixels;      // of the tiles that the histories are of
    std::vector<uint> histories;  // [tile * lights + light], see kernels/shared/ward.h
};

class Ward : public Sampler {
  public:
    explicit Ward(WardOptions options) : options_(std::move(options)) {}

    [[nodiscard]] Estimate estimate(const Tracer& tracer, const Point& point,
                                    const PixelDraws& draws) const override;

  private:
    WardOptions options_;
};

/// A light's hit history in a tile, and how many of its probes rounding decides.
struct History {
    uint traced = 0, passed = 0, undecided = 0;
};

/// Stage histories for one light of a tile, which is tile `number` of the image, from the surfaces
/// of its items (their w negative where there is none), from item `first` of the batch on.
[[nodiscard]] History hit_history(const Scene& scene, const Tracer& tracer, const Viewers& viewers,
                                  std::size_t first, std::span<const Surface> items, uint number,
                                  uint light, uint seed);

}  // namespace manylight::reference

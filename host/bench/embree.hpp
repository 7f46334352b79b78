// SPDX-License-Identifier: MIT
// Embree's interfaces, to measure against; without Embree at build time there are none.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "bench/rays.hpp"

namespace manylight {

/// One way to trace a set of rays: prepare() is not timed, run() is, collect() gives what was
/// found: [16 * packet + lane] t, or infinity where nothing is hit; any hit: 0 where something is.
struct Tracing {
    std::string name;
    std::function<void(const RaySet&)> prepare;
    std::function<void()> run;
    std::function<std::vector<float>()> collect;
};

/// A scene in Embree.
class EmbreeScene {
  public:
    /// Builds its BVH, of medium quality, with `threads` threads.
    EmbreeScene(const Scene& scene, unsigned threads);
    ~EmbreeScene();

    [[nodiscard]] static bool available();
    [[nodiscard]] double build_seconds() const;
    [[nodiscard]] std::size_t memory_bytes() const;

    /// rtcIntersect1 (rtcOccluded1) first, then packets of 4, 8 and 16, then streams.
    [[nodiscard]] std::vector<Tracing> interfaces(bool any_hit) const;

    struct Built;

  private:
    std::shared_ptr<Built> built_;
};

}  // namespace manylight

// SPDX-License-Identifier: MIT
// Throughput of ray traversal, on a device and in Embree, on the same rays.
#pragma once

#include <functional>

#include "bench/embree.hpp"
#include "reference/tracing.hpp"
#include "stages/device_scene.hpp"
#include "statistics.hpp"

namespace manylight {

/// What one way to trace a set of rays took.
struct TracingResult {
    std::string name;
    std::vector<double> seconds;  // [round]
    std::size_t differences = 0;  // from the reference, over the rays that it judged
};

/// All ways to trace one set, with rounds in which they took turns.
struct RaySetResult {
    std::string name;
    std::size_t rays = 0;
    std::size_t judged = 0;              // rays that the reference traced too
    std::vector<TracingResult> kernels;  // packets first, then single rays
    std::vector<TracingResult> embree;   // single rays first; empty without Embree
};

/// A scene's BVH on a device, with the kernels that trace rays through it.
class DeviceTracer {
  public:
    DeviceTracer(const Device& device, const DeviceScene& scene);

    /// Packets, and single rays.
    [[nodiscard]] std::vector<Tracing> tracings(bool any_hit) const;

  private:
    struct Shared;
    std::shared_ptr<Shared> shared_;
};

/// Traces a set in every way, once to warm up and to be judged, then `rounds` times in turn. Throws
/// RuntimeError, naming the way and the ray, where a result is wrong: it differs from the
/// reference's by more than rounding of the ray's ends explains.
[[nodiscard]] RaySetResult measure(const RaySet& set, const reference::Tracer& tracer, float reach,
                                   const std::vector<Tracing>& kernels,
                                   const std::vector<Tracing>& embree, unsigned rounds,
                                   const std::function<void()>& progress);

}  // namespace manylight

// SPDX-License-Identifier: MIT
#include "bench/traversal.hpp"

#include <algorithm>

#include "clock.hpp"
#include "error.hpp"

namespace manylight {
namespace {

constexpr std::size_t least_rays = 2'000'000;  // in a time that is taken
constexpr std::size_t most_judged = 20'000;
constexpr float infinity = std::numeric_limits<float>::infinity();

reference::Ray ray_of(const RaySet& set, std::size_t i) {
    const RayPacket& p = set.packets[i / 16];
    return {p.origin, glm::dvec3(p.x[i % 16], p.y[i % 16], p.z[i % 16]), p.end[i % 16],
            p.start[i % 16]};
}

// Whether what a ray found is what the reference finds, or finds for a ray that single precision
// cannot tell from it.
bool is_right(const reference::Tracer& tracer, const reference::Ray& ray, bool any_hit, float found,
              double shift) {
    const auto agrees = [&](const reference::Ray& r) {
        const auto hit = tracer.closest_hit(r);
        if (hit.has_value() != (found < infinity)) return false;
        return any_hit || !hit || std::abs(hit->t - found) <= 1e-4 * hit->t;
    };
    return agrees(ray) ||
           std::ranges::any_of(
               reference::Tracer::neighbours(ray, {glm::dvec3(shift), glm::dvec3(shift)}), agrees);
}

std::size_t judge(const RaySet& set, const reference::Tracer& tracer, float reach,
                  const Tracing& tracing, std::size_t& judged) {
    const std::vector<float> found = tracing.collect();
    const std::size_t step = std::max<std::size_t>(found.size() / most_judged, 1) | 1;
    std::size_t differences = 0;
    judged = 0;
    for (std::size_t i = 0; i < found.size(); i += step) {
        const reference::Ray ray = ray_of(set, i);
        if (!(ray.end > 0)) continue;
        ++judged;
        if (!is_right(tracer, ray, set.any_hit, found[i], 32 * 1.2e-7 * reach)) ++differences;
    }
    return differences;
}

}  // namespace

struct DeviceTracer::Shared {
    Device device;
    Arguments arguments;
    Defines defines;
    Buffer<float4> origins;
    Buffer<float> rays;
    Buffer<float> starts;
    Buffer<uint> triangles;
    std::size_t packets = 0;

    void prepare(const RaySet& set) {
        packets = set.packets.size();
        std::vector<float4> sources;
        std::vector<float> from;
        std::vector<float> lanes;
        lanes.reserve(64 * packets);
        for (const RayPacket& p : set.packets) {
            sources.emplace_back(p.origin, 0);
            from.insert(from.end(), p.start.begin(), p.start.end());
            for (const auto& row : {p.x, p.y, p.z, p.end})
                lanes.insert(lanes.end(), row.begin(), row.end());
        }
        origins = device.upload(sources);
        starts = device.upload(from);
        rays = device.upload(lanes);
        if (!set.any_hit) triangles = device.allocate<uint>(16 * packets);
        arguments.set("origins", origins)
            .set("rays", rays)
            .set("packet_count", static_cast<uint>(packets));
        if (!set.any_hit) arguments.set("triangles", triangles).set("starts", starts);
        device.finish();
    }

    [[nodiscard]] std::vector<float> collect(bool any_hit) const {
        const std::vector<float> lanes = rays.download();
        std::vector<uint> hits;
        if (!any_hit) hits = triangles.download();
        std::vector<float> found(16 * packets, infinity);
        for (std::size_t i = 0; i < found.size(); ++i) {
            const float end = lanes[64 * (i / 16) + 48 + i % 16];
            if (any_hit ? end < 0 : hits[i] != ~0u) found[i] = any_hit ? 0 : end;
        }
        return found;
    }
};

DeviceTracer::DeviceTracer(const Device& device, const DeviceScene& scene)
    : shared_(new Shared{device, scene.arguments, scene.traversal, {}, {}, {}, {}, 0}) {}

std::vector<Tracing> DeviceTracer::tracings(bool any_hit) const {
    std::vector<Tracing> out;
    const unsigned lanes = shared_->device.form().lanes;
    for (const bool packets : {true, false}) {
        if (packets && lanes == 1) continue;
        const std::string kernel = fmt::format("{}_{}", any_hit ? "shadows_trace" : "bench_closest",
                                               packets ? "packets" : "rays");
        Kernel traced = shared_->device.kernel(any_hit ? "shadows.cl" : "bench.cl", kernel,
                                               shared_->defines, "bench");
        Tracing tracing;
        tracing.name = packets ? "packets" : "single rays";
        tracing.prepare = [shared = shared_](const RaySet& set) { shared->prepare(set); };
        tracing.run = [shared = shared_, traced, packets]() mutable {
            traced.launch(shared->packets * (packets ? 1 : 16), shared->arguments);
            shared->device.finish();
        };
        tracing.collect = [shared = shared_, any_hit] { return shared->collect(any_hit); };
        out.push_back(tracing);
    }
    return out;
}

RaySetResult measure(const RaySet& set, const reference::Tracer& tracer, float reach,
                     const std::vector<Tracing>& kernels, const std::vector<Tracing>& embree,
                     unsigned rounds, const std::function<void()>& progress) {
    RaySetResult result{set.name, set.ray_count(), 0, {}, {}};
    std::vector<std::pair<const Tracing*, TracingResult*>> all;
    result.kernels.resize(kernels.size());
    result.embree.resize(embree.size());
    for (std::size_t i = 0; i < kernels.size(); ++i)
        all.emplace_back(&kernels[i], &result.kernels[i]);
    for (std::size_t i = 0; i < embree.size(); ++i) all.emplace_back(&embree[i], &result.embree[i]);
    const std::size_t repeats = std::max<std::size_t>(least_rays / result.rays, 1);
    for (unsigned round = 0; round <= rounds; ++round)
        for (const auto& [tracing, out] : all) {
            double seconds = 0;
            for (std::size_t i = 0; i < repeats; ++i) {
                tracing->prepare(set);
                const auto start = Clock::now();
                tracing->run();
                seconds += seconds_since(start) / static_cast<double>(repeats);
            }
            progress();
            if (round > 0) {
                out->seconds.push_back(seconds);
                continue;
            }
            out->name = tracing->name;
            out->differences = judge(set, tracer, reach, *tracing, result.judged);
        }
    return result;
}

}  // namespace manylight

// SPDX-License-Identifier: MIT
#include "bench/embree.hpp"

#include "error.hpp"

#if MANYLIGHT_EMBREE
#include <embree3/rtcore.h>

#include <algorithm>
#include <atomic>
#include <thread>

#include "clock.hpp"

namespace manylight {

struct EmbreeScene::Built {
    RTCDevice device = nullptr;
    RTCScene scene = nullptr;
    std::atomic<std::int64_t> memory = 0;
    double seconds = 0;
    unsigned threads = 1;

    ~Built() {
        rtcReleaseScene(scene);
        rtcReleaseDevice(device);
    }

    // Calls work(begin, end) over chunks of `count` items on all threads.
    template <class Work>
    void for_chunks(std::size_t count, Work work) const {
        constexpr std::size_t chunk = 256;
        std::atomic<std::size_t> next = 0;
        const auto loop = [&] {
            for (std::size_t begin; (begin = next.fetch_add(chunk)) < count;)
                work(begin, std::min(begin + chunk, count));
        };
        std::vector<std::jthread> others;
        for (unsigned i = 1; i < threads; ++i) others.emplace_back(loop);
        loop();
    }
};

namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();

// A packet type of Embree with what a template needs of it; N lanes.
template <int N>
struct Packets;
#define PACKETS(N)                                                                        \
    template <>                                                                           \
    struct Packets<N> {                                                                   \
        using RayHit = RTCRayHit##N;                                                      \
        static void trace(const int* valid, RTCScene scene, RTCIntersectContext* context, \
                          RayHit* ray, bool any_hit) {                                    \
            any_hit ? rtcOccluded##N(valid, scene, context, &ray->ray)                    \
                    : rtcIntersect##N(valid, scene, context, ray);                        \
        }                                                                                 \
    };
PACKETS(4)
PACKETS(8)
PACKETS(16)
#undef PACKETS

RTCIntersectContext make_context(bool coherent) {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags =
        coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
    return context;
}

// The rays of a set in Embree's layout, N lanes side by side; empty lanes are negative intervals.
template <int N>
struct Rays {
    std::vector<typename Packets<N>::RayHit> rays;
    bool coherent = false;

    void prepare(const RaySet& set) {
        coherent = set.coherent;
        rays.resize(set.packets.size() * 16 / N);
        for (std::size_t i = 0; i < rays.size() * N; ++i) {
            const RayPacket& p = set.packets[i / 16];
            auto& [ray, hit] = rays[i / N];
            const std::size_t from = i % 16;
            const std::size_t to = i % N;
            ray.org_x[to] = p.origin.x;
            ray.org_y[to] = p.origin.y;
            ray.org_z[to] = p.origin.z;
            ray.dir_x[to] = p.x[from];
            ray.dir_y[to] = p.y[from];
            ray.dir_z[to] = p.z[from];
            ray.tnear[to] = p.start[from];
            ray.tfar[to] = p.end[from] > 0 ? p.end[from] : -1;
            ray.time[to] = 0;
            ray.mask[to] = ~0u;
            ray.id[to] = 0;
            ray.flags[to] = 0;
            hit.geomID[to] = RTC_INVALID_GEOMETRY_ID;
            hit.instID[0][to] = RTC_INVALID_GEOMETRY_ID;
        }
    }

    [[nodiscard]] std::vector<float> collect(bool any_hit) const {
        std::vector<float> found(rays.size() * N, infinity);
        for (std::size_t i = 0; i < found.size(); ++i) {
            const auto& [ray, hit] = rays[i / N];
            const bool is_hit = any_hit ? ray.tfar[i % N] == -infinity
                                        : hit.geomID[i % N] != RTC_INVALID_GEOMETRY_ID;
            if (is_hit) found[i] = any_hit ? 0 : ray.tfar[i % N];
        }
        return found;
    }
};

struct SingleRays {
    std::vector<RTCRayHit> rays;
    bool coherent = false;

    void prepare(const RaySet& set) {
        coherent = set.coherent;
        rays.resize(set.packets.size() * 16);
        for (std::size_t i = 0; i < rays.size(); ++i) {
            const RayPacket& p = set.packets[i / 16];
            RTCRayHit& r = rays[i];
            r.ray = {p.origin.x,
                     p.origin.y,
                     p.origin.z,
                     p.start[i % 16],
                     p.x[i % 16],
                     p.y[i % 16],
                     p.z[i % 16],
                     0,
                     p.end[i % 16] > 0 ? p.end[i % 16] : -1,
                     ~0u,
                     0,
                     0};
            r.hit.geomID = RTC_INVALID_GEOMETRY_ID;
            r.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
        }
    }

    [[nodiscard]] std::vector<float> collect(bool any_hit) const {
        std::vector<float> found(rays.size(), infinity);
        for (std::size_t i = 0; i < found.size(); ++i) {
            const bool is_hit = any_hit ? rays[i].ray.tfar == -infinity
                                        : rays[i].hit.geomID != RTC_INVALID_GEOMETRY_ID;
            if (is_hit) found[i] = any_hit ? 0 : rays[i].ray.tfar;
        }
        return found;
    }
};

template <int N>
Tracing packets(const std::shared_ptr<EmbreeScene::Built>& built, bool any_hit, bool stream) {
    auto rays = std::make_shared<Rays<N>>();
    Tracing out;
    out.name = stream ? "embree streams of packets" : fmt::format("embree packets of {}", N);
    out.prepare = [rays](const RaySet& set) { rays->prepare(set); };
    out.collect = [rays, any_hit] { return rays->collect(any_hit); };
    out.run = [=] {
        built->for_chunks(rays->rays.size(), [&](std::size_t begin, std::size_t end) {
            RTCIntersectContext context = make_context(rays->coherent);
            auto* first = rays->rays.data() + begin;
            const auto count = static_cast<unsigned>(end - begin);
            using RayHit = typename Packets<N>::RayHit;
            if (stream && any_hit)
                rtcOccludedNM(built->scene, &context, reinterpret_cast<RTCRayN*>(first), N, count,
                              sizeof(RayHit));
            else if (stream)
                rtcIntersectNM(built->scene, &context, reinterpret_cast<RTCRayHitN*>(first), N,
                               count, sizeof(RayHit));
            else
                for (unsigned i = 0; i < count; ++i) {
                    alignas(64) int valid[N];
                    for (int k = 0; k < N; ++k) valid[k] = first[i].ray.tfar[k] > 0 ? -1 : 0;
                    Packets<N>::trace(valid, built->scene, &context, first + i, any_hit);
                }
        });
    };
    return out;
}

Tracing singles(const std::shared_ptr<EmbreeScene::Built>& built, bool any_hit, bool stream) {
    auto rays = std::make_shared<SingleRays>();
    Tracing out;
    out.name = stream ? "embree streams of rays" : "embree single rays";
    out.prepare = [rays](const RaySet& set) { rays->prepare(set); };
    out.collect = [rays, any_hit] { return rays->collect(any_hit); };
    out.run = [=] {
        built->for_chunks(rays->rays.size() / 16, [&](std::size_t begin, std::size_t end) {
            RTCIntersectContext context = make_context(rays->coherent);
            RTCRayHit* first = rays->rays.data() + begin * 16;
            const auto count = static_cast<unsigned>(16 * (end - begin));
            if (stream && any_hit)
                rtcOccluded1M(built->scene, &context, &first->ray, count, sizeof(RTCRayHit));
            else if (stream)
                rtcIntersect1M(built->scene, &context, first, count, sizeof(RTCRayHit));
            else
                for (unsigned i = 0; i < count; ++i) {
                    if (first[i].ray.tfar < 0) continue;
                    any_hit ? rtcOccluded1(built->scene, &context, &first[i].ray)
                            : rtcIntersect1(built->scene, &context, first + i);
                }
        });
    };
    return out;
}

}  // namespace

bool EmbreeScene::available() { return true; }

EmbreeScene::EmbreeScene(const Scene& scene, unsigned threads) : built_(new Built) {
    built_->threads = threads;
    built_->device = rtcNewDevice(fmt::format("threads={}", threads).c_str());
    if (!built_->device) throw RuntimeError("Embree cannot be used");
    rtcSetDeviceMemoryMonitorFunction(
        built_->device,
        [](void* user, ssize_t bytes, bool) {
            *static_cast<std::atomic<std::int64_t>*>(user) += bytes;
            return true;
        },
        &built_->memory);
    const auto start = Clock::now();
    built_->scene = rtcNewScene(built_->device);
    rtcSetSceneBuildQuality(built_->scene, RTC_BUILD_QUALITY_MEDIUM);
    RTCGeometry mesh = rtcNewGeometry(built_->device, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* vertices = static_cast<glm::vec3*>(
        rtcSetNewGeometryBuffer(mesh, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                sizeof(glm::vec3), scene.vertices.size()));
    std::ranges::copy(scene.vertices, vertices);
    auto* indices = static_cast<std::uint32_t*>(rtcSetNewGeometryBuffer(
        mesh, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12, scene.triangle_count()));
    std::ranges::copy(scene.indices, indices);
    rtcCommitGeometry(mesh);
    rtcAttachGeometry(built_->scene, mesh);
    rtcReleaseGeometry(mesh);
    rtcCommitScene(built_->scene);
    built_->seconds = seconds_since(start);
}

EmbreeScene::~EmbreeScene() = default;

double EmbreeScene::build_seconds() const { return built_->seconds; }

std::size_t EmbreeScene::memory_bytes() const {
    return static_cast<std::size_t>(built_->memory.load());
}

std::vector<Tracing> EmbreeScene::interfaces(bool any_hit) const {
    return {singles(built_, any_hit, false),    packets<4>(built_, any_hit, false),
            packets<8>(built_, any_hit, false), packets<16>(built_, any_hit, false),
            singles(built_, any_hit, true),     packets<16>(built_, any_hit, true)};
}

}  // namespace manylight

#else

namespace manylight {

struct EmbreeScene::Built {};

bool EmbreeScene::available() { return false; }
EmbreeScene::EmbreeScene(const Scene&, unsigned) {
    throw RuntimeError("this program was built without Embree");
}
EmbreeScene::~EmbreeScene() = default;
double EmbreeScene::build_seconds() const { return 0; }
std::size_t EmbreeScene::memory_bytes() const { return 0; }
std::vector<Tracing> EmbreeScene::interfaces(bool) const { return {}; }

}  // namespace manylight

#endif

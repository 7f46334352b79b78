// SPDX-License-Identifier: MIT
#include "bench/rays.hpp"

#include <algorithm>
#include <optional>
#include <random>

#include "lights/lights.hpp"
#include "reference/gbuffer.hpp"

namespace manylight {
namespace {

struct Segment {
    glm::vec3 origin, direction;
    float end;
};

// The shadow ray from a surface to a light (to an area light's centroid), if they face each other.
std::optional<Segment> segment_to(const Light& light, const Surface& surface) {
    const glm::vec3 normal(surface.horizon);
    Segment s{glm::vec3(surface.position) + normal * surface.horizon.w, {}, 1};
    glm::vec3 target = extent_of<float>(light).centre;
    if (light_has(light, TRAIT_COSINE)) {
        const glm::vec3 facing = light_has(light, TRAIT_AREA)
                                     ? glm::vec3(glm::normalize(area_normal(light)))
                                     : glm::vec3(light.axis);
        if (glm::dot(facing, s.origin - target) <= 0) return {};
        target += facing * light.edge.w;
    }
    const bool infinite = light_has(light, TRAIT_INFINITE);
    s.direction = infinite ? target : target - s.origin;
    if (infinite) s.end = std::numeric_limits<float>::infinity();
    if (glm::dot(normal, s.direction) <= 0) return {};
    return s;
}

void put(RayPacket& packet, std::size_t lane, const Segment& s) {
    packet.x[lane] = s.direction.x;
    packet.y[lane] = s.direction.y;
    packet.z[lane] = s.direction.z;
    packet.end[lane] = s.end;
}

}  // namespace

std::size_t RaySet::ray_count() const {
    std::size_t count = 0;
    for (const RayPacket& packet : packets)
        count += static_cast<std::size_t>(
            std::ranges::count_if(packet.end, [](float end) { return end > 0; }));
    return count;
}

RaySet primary_rays(const Camera& camera, const Tiles& tiles) {
    RaySet set{"primary", false, true, {}};
    // Rays of an orthographic camera share no origin: each has its own packet.
    const std::size_t lanes = camera.forward.w == 0 ? 16 : 1;
    set.packets.resize(item_count(tiles) / lanes);
    for (std::size_t item = 0; item < item_count(tiles); ++item) {
        const glm::uvec2 pixel = item_pixel(tiles, item);
        const reference::Ray ray =
            reference::primary_ray(camera, tiles, glm::dvec2(pixel) + glm::dvec2(0.5));
        RayPacket& packet = set.packets[item / lanes];
        packet.origin = ray.origin;
        put(packet, item % lanes, {packet.origin, ray.direction, static_cast<float>(ray.end)});
        packet.start[item % lanes] = static_cast<float>(ray.start);
    }
    return set;
}

RaySet incoherent_shadow_rays(const Scene& scene, const std::vector<Surface>& surfaces) {
    RaySet set{"shadow_incoherent", true, false, {}};
    std::mt19937 engine(1);
    std::uniform_real_distribution<float> unit(0, 1);
    std::vector<Segment> facing;
    for (const Surface& surface : surfaces) {
        if (surface.position.w < 0) continue;
        facing.clear();
        for (const Light& light : scene.lights)
            if (const auto segment = segment_to(light, surface)) facing.push_back(*segment);
        if (facing.empty()) continue;
        RayPacket& packet = set.packets.emplace_back();
        packet.origin = facing[0].origin;
        for (std::size_t lane = 0; lane < 16; ++lane) {
            const float u = (static_cast<float>(lane) + unit(engine)) / 16;
            const auto drawn = static_cast<std::size_t>(u * static_cast<float>(facing.size()));
            put(packet, lane, facing[std::min(drawn, facing.size() - 1)]);
        }
    }
    return set;
}

RaySet coherent_shadow_rays(const Scene& scene, const std::vector<Surface>& surfaces) {
    RaySet set{"shadow_coherent", true, true, {}};
    const std::size_t step = std::max<std::size_t>(scene.lights.size() / 16, 1);
    for (std::size_t y = 0; y < std::min(step * 16, scene.lights.size()); y += step)
        for (std::size_t first = 0; first + 16 <= surfaces.size(); first += 16) {
            RayPacket packet{};
            for (std::size_t lane = 0; lane < 16; ++lane) {
                const Surface& surface = surfaces[first + lane];
                if (surface.position.w < 0) continue;
                const auto segment = segment_to(scene.lights[y], surface);
                if (!segment || std::isinf(segment->end)) continue;
                packet.origin = segment->origin + segment->direction;
                put(packet, lane, {packet.origin, -segment->direction, 1});
            }
            if (std::ranges::any_of(packet.end, [](float end) { return end > 0; }))
                set.packets.push_back(packet);
        }
    return set;
}

}  // namespace manylight

// SPDX-License-Identifier: MIT
// Rays of a view, for benchmarks: every implementation traces the same ones.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "scene/scene.hpp"
#include "shared/surface.h"
#include "stages/tiles.hpp"

namespace manylight {

/// 16 segments origin + t direction, start < t < end, world space; a lane whose end is not positive
/// holds none. Lane by lane, as in kernels/lib/rays.h.
struct RayPacket {
    glm::vec3 origin;
    std::array<float, 16> x, y, z, end;
    std::array<float, 16> start;  // 0 where any hit is asked for
};

/// Rays, and what is asked of them.
struct RaySet {
    std::string name;
    bool any_hit = false;   // whether something is hit, or else what is hit first
    bool coherent = false;  // a hint to Embree
    std::vector<RayPacket> packets;

    /// Lanes that hold a ray.
    [[nodiscard]] std::size_t ray_count() const;
};

/// Primary rays through pixel centres: packets of 16 items, blocks of 4 x 4 pixels.
[[nodiscard]] RaySet primary_rays(const Camera& camera, const Tiles& tiles);

/// A packet per surface: segments to 16 of the lights that face it, drawn stratified from them.
[[nodiscard]] RaySet incoherent_shadow_rays(const Scene& scene,
                                            const std::vector<Surface>& surfaces);

/// Packets from a light to 16 neighbouring surfaces, for 16 lights spread over all.
[[nodiscard]] RaySet coherent_shadow_rays(const Scene& scene, const std::vector<Surface>& surfaces);

}  // namespace manylight

// SPDX-License-Identifier: MIT
#include "stages/seen_lights.hpp"

#include <algorithm>

namespace manylight {

SeenLightsStage::SeenLightsStage(Device& device, const DeviceScene& scene)
    : device_(device),
      gbuffer_(device, scene),
      scene_(scene.arguments),
      light_count_(scene.light_count),
      find_(device.kernel("seen_lights.cl", "seen_lights_find", scene.shading, "seen_lights")) {}

uint SeenLightsStage::rays_per_light(std::size_t lights, std::size_t pixels) {
    constexpr std::size_t fewest = 16;  // less says little of a light
    constexpr std::size_t most = 256;
    const std::size_t all = std::max<std::size_t>(2 * pixels, std::size_t{1} << 18);
    const std::size_t rays = all / std::max<std::size_t>(lights, 1);
    return rays < fewest ? 0 : static_cast<uint>(std::min(rays, most));
}

std::vector<bool> SeenLightsStage::find(uint rays, uint seed) {
    const Tiles tiles = all_tiles(points_side, points_side, points_side);
    Buffer<Surface> surfaces = device_.allocate<Surface>(item_count(tiles));
    gbuffer_.trace(tiles, {0, seed, true}, surfaces);
    const Buffer<uint> seen = device_.allocate<uint>(light_count_);
    find_.launch(light_count_, Arguments(scene_)
                                   .set("tiles", tiles)
                                   .set("surfaces", surfaces)
                                   .set("most_rays", rays)
                                   .set("seed", seed)
                                   .set("seen", seen));
    const std::vector<uint> found = seen.download();
    return {found.begin(), found.end()};
}

}  // namespace manylight

// SPDX-License-Identifier: MIT
#include "samplers/adaptive/seen_lights.hpp"

namespace manylight {

SeenLightsStage::SeenLightsStage(Device& device, const DeviceScene& scene, uint rays)
    : device_(device),
      gbuffer_(device, scene),
      scene_(scene.arguments),
      light_count_(scene.light_count),
      rays_(rays),
      find_(device.kernel("samplers/adaptive/seen_lights.cl", "seen_lights_find", scene.shading,
                          "seen_lights")) {}

Buffer<Surface> SeenLightsStage::look(uint seed) {
    Buffer<Surface> surfaces = device_.allocate<Surface>(item_count(points()));
    gbuffer_.trace(points(), {0, seed, true}, surfaces);
    return surfaces;
}

std::vector<bool> SeenLightsStage::find(const Buffer<Surface>& surfaces, uint seed) {
    const Buffer<uint> seen = device_.allocate<uint>(light_count_);
    find_.launch(light_count_, Arguments(scene_)
                                   .set("tiles", points())
                                   .set("surfaces", surfaces)
                                   .set("most_rays", rays_)
                                   .set("seed", seed)
                                   .set("seen", seen));
    const std::vector<uint> found = seen.download();
    return {found.begin(), found.end()};
}

}  // namespace manylight

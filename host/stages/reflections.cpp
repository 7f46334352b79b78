// SPDX-License-Identifier: MIT
#include "stages/reflections.hpp"

namespace manylight {

namespace {

Defines defines_of(const DeviceScene& scene) {
    Defines defines = scene.shading;
    defines["HAS_TEXTURES"] = scene.surfaces.at("HAS_TEXTURES");
    return defines;
}

}  // namespace

ReflectionStage::ReflectionStage(Device& device, const DeviceScene& scene)
    : scene_(scene.arguments),
      add_(device.kernel("reflections.cl", "reflections_add", defines_of(scene), "reflections")) {}

void ReflectionStage::add(const Tiles& tiles, const PixelSample& sample,
                          const Buffer<Surface>& surfaces, Buffer<float4>& estimates) {
    add_.launch(item_count(tiles), Arguments(scene_)
                                       .set("tiles", tiles)
                                       .set("surfaces", surfaces)
                                       .set("alpha_salt", sample.salt())
                                       .set("pixel_sample", sample.index)
                                       .set("seed", sample.seed)
                                       .set("estimates", estimates));
}

}  // namespace manylight

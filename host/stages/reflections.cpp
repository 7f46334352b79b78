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

ReflectionStage::ReflectionStage(Device& device, const DeviceScene& scene, std::size_t items,
                                 std::string_view closed_form)
    : scene_(scene.arguments),
      trace_(
          device.kernel("reflections.cl", "reflections_trace", defines_of(scene), "reflections")),
      add_(device.kernel(closed_form.empty() ? "reflected.cl" : closed_form, "reflections_add",
                         scene.shading, "reflections")),
      reflected_(device.allocate<Reflected>(items)) {}

void ReflectionStage::add(const Tiles& tiles, const PixelSample& sample, uint light_samples,
                          const Buffer<Surface>& surfaces, const Arguments& tables,
                          Buffer<float4>& estimates) {
    trace_.launch(item_count(tiles), Arguments(scene_)
                                         .set("tiles", tiles)
                                         .set("surfaces", surfaces)
                                         .set("alpha_salt", sample.salt())
                                         .set("pixel_sample", sample.index)
                                         .set("seed", sample.seed)
                                         .set("reflected", reflected_));
    add_reflected(tiles, light_samples, surfaces, tables, reflected_, estimates);
}

void ReflectionStage::add_reflected(const Tiles& tiles, uint light_samples,
                                    const Buffer<Surface>& surfaces, const Arguments& tables,
                                    const Buffer<Reflected>& reflected, Buffer<float4>& estimates) {
    add_.launch(item_count(tiles), Arguments(scene_)
                                       .set(tables)
                                       .set("tiles", tiles)
                                       .set("surfaces", surfaces)
                                       .set("sample_count", light_samples)
                                       .set("reflected", reflected)
                                       .set("estimates", estimates));
}

}  // namespace manylight

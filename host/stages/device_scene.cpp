// SPDX-License-Identifier: MIT
#include "stages/device_scene.hpp"

#include <algorithm>
#include <cctype>

namespace manylight {
namespace {

std::span<const float> flat(const std::vector<glm::vec3>& vectors) {
    static_assert(sizeof(glm::vec3) == 3 * sizeof(float));
    return {vectors.empty() ? nullptr : &vectors[0].x, 3 * vectors.size()};
}

Defines kind_defines(const Features& features) {
    Defines defines;
#define DEFINE_KIND(name, NAME, value) defines["HAS_" #NAME] = features.kinds[value];
    LIGHT_KINDS(DEFINE_KIND)
#undef DEFINE_KIND
    return defines;
}

}  // namespace

unsigned lanes_for(const DeviceInfo& device) {
    if (device.is_gpu) return 4;
    return device.float_width >= 16 ? 16 : device.float_width >= 8 ? 8 : 4;
}

DeviceScene upload_scene(Device& device, const Scene& scene, const WideBvh& bvh,
                         const Camera& camera, const LightTree* tree) {
    const Features features = find_features(scene);
    DeviceScene out;
    out.light_count = static_cast<uint>(scene.lights.size());
    out.packets = !device.info().is_gpu;
    out.primary_packets = out.packets && camera.forward.w == 0;
    out.arguments.set("camera", camera)
        .set("bvh_nodes", device.upload(bvh.nodes))
        .set("bvh_blocks", device.upload(bvh.blocks))
        .set("vertices", device.upload(flat(scene.vertices)))
        .set("indices", device.upload(scene.indices))
        .set("triangle_materials", device.upload(scene.triangle_materials))
        .set("materials", device.upload(scene.materials))
        .set("lights", device.upload(tree ? tree->lights : scene.lights))
        .set("light_count", out.light_count);
    if (features.smooth)
        out.arguments.set("vertex_normals", device.upload(flat(scene.vertex_normals)));
    if (features.reflections) out.arguments.set("cell_areas", device.upload(scene.cell_areas));
    if (tree)
        out.arguments.set("nodes", device.upload(tree->nodes))
            .set("root_count", static_cast<uint>(tree->roots.size()))
            .set("second_root", tree->roots.size() > 1 ? tree->roots[1] : 0);
    out.traversal = {{"BVH_WIDTH", static_cast<int>(bvh.width)},
                     {"BVH_BLOCK", static_cast<int>(bvh.block)},
                     {"BVH_STACK", static_cast<int>(bvh.stack)}};
    out.surfaces = out.traversal;
    out.surfaces["HAS_SMOOTH"] = features.smooth;
    out.shading = out.traversal;
    out.shading.merge(kind_defines(features));
    out.shading["HAS_GGX"] = features.ggx;
    out.shading["HAS_REFLECTIONS"] = features.reflections;
    out.emission = {{"HAS_EMISSION", features.emission}};
    return out;
}

}  // namespace manylight

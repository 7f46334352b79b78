// SPDX-License-Identifier: MIT
#pragma once

#include "bvh/wide.hpp"
#include "device/device.hpp"
#include "light_tree/light_tree.hpp"
#include "scene/scene.hpp"
#include "shared/surface.h"

namespace manylight {

/// A scene on a device, seen by one camera: what every stage reads.
struct DeviceScene {
    Arguments arguments;  // camera, bvh_*, vertices, indices, materials, lights, light_count, ...
    Defines traversal;    // for kernels that trace rays
    Defines surfaces;     // for kernels that make surfaces of hits
    Defines shading;      // for kernels that evaluate lights and materials, traversal included
    Defines emission;     // for kernels that add what surfaces emit
    uint light_count = 0;
    Buffer<Light> lights;
    Buffer<LightNode> nodes;     // of the light trees, if any
    Buffer<uint> cell_lights;    // of Scene::light_cells, where rays of stage reflections need them
    Buffer<Material> materials;  // the scene's, and behind them those of points (see GBufferStage)
    uint own_materials = 0;      // index of the first of these
    bool varies_materials = false;
    bool packets = false;          // rays with one origin are traced together
    bool primary_packets = false;  // ... and primary rays have one origin
};

/// Uploads a scene whose lights are complete (add_emitters): in the order of `tree`, and with its
/// nodes (nodes, root_count, second_root), if there is one. Scene and BVH must outlive the result.
/// `points`: how many points have a material of their own where the scene varies them.
[[nodiscard]] DeviceScene upload_scene(Device& device, const Scene& scene, const WideBvh& bvh,
                                       const Camera& camera, const LightTree* tree = nullptr,
                                       std::size_t points = 0);

/// The scene with other lights, as upload_scene() takes them: virtual ones, for instance. Rays of
/// stage reflections meet the scene's own lights only.
[[nodiscard]] DeviceScene with_lights(Device& device, DeviceScene scene,
                                      const std::vector<Light>& lights,
                                      const LightTree* tree = nullptr);

/// Makes room for the light tree of a scene that was uploaded without, with arguments nodes,
/// root_count and second_root for kernels that are launched once fill_tree() has come.
void reserve_tree(Device& device, const std::vector<Light>& lights, DeviceScene& scene);

/// Puts the lights in the tree's order, also for kernels that have the scene's arguments already.
void fill_tree(const LightTree& tree, DeviceScene& scene);

/// From now on the stages that light points take them for receivers that no camera sees:
/// `outgoing`[item] belongs to surfaces[item]. Kernels that were made before are not concerned.
void set_outgoing(DeviceScene& scene, const Buffer<Outgoing>& outgoing);

/// The bytes on the device that upload_scene() takes, but for points' materials.
[[nodiscard]] std::size_t scene_bytes(const Scene& scene, const WideBvh& bvh, bool tree);

}  // namespace manylight

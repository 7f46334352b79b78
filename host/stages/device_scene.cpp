// SPDX-License-Identifier: MIT
#include "stages/device_scene.hpp"

#include <algorithm>
#include <cctype>

namespace manylight {
namespace {

void set_lights(Device& device, const std::vector<Light>& lights, const LightTree* tree,
                DeviceScene& out) {
    out.light_count = static_cast<uint>(lights.size());
    out.lights = device.upload(lights);
    out.arguments.set("lights", out.lights).set("light_count", out.light_count);
    if (tree) {
        reserve_tree(device, lights, out);
        fill_tree(*tree, out);
    }
    bool kinds[light_kind_count] = {};
    for (const Light& light : lights) kinds[static_cast<std::size_t>(light.position.w)] = true;
    const auto has = [&kinds](LightTrait trait) {
        for (uint kind = 0; kind < light_kind_count; ++kind)
            if (kinds[kind] && light_has(kind, trait)) return true;
        return false;
    };
#define DEFINE_KIND(name, NAME, value, traits, centroid) out.shading["HAS_" #NAME] = kinds[value];
#define DEFINE_TRAIT(NAME, value) out.shading["HAS_" #NAME] = has(TRAIT_##NAME);
    LIGHT_KINDS(DEFINE_KIND)
    LIGHT_TRAITS(DEFINE_TRAIT)
#undef DEFINE_KIND
#undef DEFINE_TRAIT
}

// Whether a dielectric reflects otherwise than one of the index 1.5.
bool varies_reflectance(const Scene& scene) {
    for (std::size_t i = 0; i < scene.materials.size(); ++i) {
        const Material& m = scene.materials[i];
        if (m.specular > 0 && (m.reflectance != float4(glm::vec3(USUAL_REFLECTANCE), 0) ||
                               has_map(scene, i, MAP_SPECULAR_COLOR)))
            return true;
    }
    return false;
}

template <class Vector>
std::size_t bytes_of(const Vector& values) {
    return values.size() * sizeof(values[0]);
}

void set_textures(Device& device, const Scene& scene, Arguments& arguments) {
    const std::size_t vertices = scene.vertices.size();
    Buffer<glm::vec2> coordinates = device.allocate<glm::vec2>(scene.coordinates.size() * vertices);
    for (std::size_t set = 0; set < scene.coordinates.size(); ++set)
        coordinates.upload(scene.coordinates[set], set * vertices);
    const Buffer<Texture> textures = device.upload(scene.textures);
    const Buffer<std::uint32_t> texels = device.share(scene.texels);
    arguments.set("maps", device.upload(scene.maps))
        .set("textures", textures)
        .set("texels", texels)
        .set("coordinates", coordinates)
        .set("vertex_count", static_cast<uint>(vertices))
        .set("alpha_textures", textures)  // traversal has its own names
        .set("alpha_texels", texels)
        .set("alpha_of", device.upload(scene.alpha_of))
        .set("alpha_triangles", device.upload(scene.alpha_triangles))
        .set("alpha_salt", 0u);
}

void set_cells(Device& device, const LightCells& cells, DeviceScene& out) {
    out.cell_lights = device.upload(cells.lights);
    out.arguments.set("grid_of", device.upload(cells.grid_of))
        .set("grids", device.upload(cells.grids))
        .set("cell_lights", out.cell_lights);
}

}  // namespace

DeviceScene upload_scene(Device& device, const Scene& scene, const WideBvh& bvh,
                         const Camera& camera, const LightTree* tree, std::size_t points) {
    const Features features = find_features(scene);
    DeviceScene out;
    out.packets = device.form().lanes > 1;
    out.primary_packets = out.packets && camera.forward.w == 0;
    out.varies_materials = scene.varies_materials();
    out.own_materials = static_cast<uint>(scene.materials.size());
    out.materials =
        device.allocate<Material>(scene.materials.size() + (out.varies_materials ? points : 0));
    out.materials.upload(scene.materials);
    out.arguments.set("camera", camera)
        .set("bvh_nodes", device.share(bvh.nodes))
        .set("bvh_blocks", device.share(bvh.blocks))
        .set("vertices", device.share(scene.vertices))
        .set("indices", device.share(scene.indices))
        .set("triangle_materials", device.share(scene.triangle_materials))
        .set("materials", out.materials);
    if (features.instances) {
        const Buffer<Instance> instances = device.upload(bvh.instances);
        out.arguments.set("instances", instances)
            .set("instance_count", static_cast<uint>(bvh.instances.size()))
            .set("bvh_instances", instances);  // traversal has its own names
    }
    if (features.smooth) out.arguments.set("vertex_normals", device.share(scene.vertex_normals));
    if (features.textures || features.alpha) set_textures(device, scene, out.arguments);
    if (features.tangents) out.arguments.set("tangents", device.upload(scene.tangents));
    if (features.colors) out.arguments.set("colors", device.upload(scene.colors));
    if (features.reflections) set_cells(device, scene.light_cells, out);
    out.traversal = {{"BVH_WIDTH", static_cast<int>(bvh.width)},
                     {"BVH_BLOCK", static_cast<int>(bvh.block)},
                     {"BVH_STACK", static_cast<int>(bvh.stack)},
                     {"HAS_ALPHA", features.alpha},
                     {"HAS_INSTANCES", features.instances}};
    out.surfaces = out.traversal;
    out.surfaces["HAS_SMOOTH"] = features.smooth;
    out.surfaces["HAS_TEXTURES"] = features.textures;
    out.surfaces["HAS_SPECULAR_MAPS"] = features.specular_maps;
    out.surfaces["HAS_TANGENTS"] = features.tangents;
    out.surfaces["HAS_COLORS"] = features.colors;
    out.shading = out.traversal;
    set_lights(device, scene.lights, tree, out);
    out.shading["HAS_GGX"] = features.ggx;
    if (varies_reflectance(scene)) out.shading["HAS_REFLECTANCE"] = 1;
    out.shading["HAS_REFLECTIONS"] = features.reflections;
    out.emission = {{"HAS_EMISSION", features.emission}, {"HAS_EMITTER_PARTS", 0}};
    return out;
}

DeviceScene with_lights(Device& device, DeviceScene scene, const std::vector<Light>& lights,
                        const LightTree* tree) {
    scene.cell_lights = {};
    set_lights(device, lights, tree, scene);
    scene.shading["HAS_REFLECTIONS"] = 0;
    return scene;
}

void reserve_tree(Device& device, const std::vector<Light>& lights, DeviceScene& scene) {
    const auto infinite =
        static_cast<std::size_t>(std::ranges::count_if(lights, [](const Light& light) {
            return light_has(static_cast<uint>(light.position.w), TRAIT_INFINITE);
        }));
    const std::size_t finite = lights.size() - infinite;
    const bool both = infinite > 0 && finite > 0;
    const uint roots = (infinite > 0 ? 1u : 0u) + (finite > 0 ? 1u : 0u);
    scene.nodes = device.allocate<LightNode>(2 * lights.size() - roots);
    scene.arguments.set("nodes", scene.nodes)
        .set("root_count", roots)
        .set("second_root", both ? static_cast<uint>(2 * infinite - 1) : 0u);
}

void fill_tree(const LightTree& tree, DeviceScene& scene) {
    scene.lights.upload(tree.lights);
    scene.nodes.upload(tree.nodes);
    if (scene.cell_lights.size() == 0) return;
    std::vector<uint> places(tree.order.size());
    for (uint place = 0; place < places.size(); ++place) places[tree.order[place]] = place;
    std::vector<uint> cells = scene.cell_lights.download();
    for (uint& light : cells)
        if (light != NO_LIGHT) light = places[light];
    scene.cell_lights.upload(cells);
}

void set_outgoing(DeviceScene& scene, const Buffer<Outgoing>& outgoing) {
    scene.arguments.set("outgoing", outgoing);
    scene.shading["HAS_OUTGOING"] = 1;
}

std::size_t scene_bytes(const Scene& scene, const WideBvh& bvh, bool tree) {
    std::size_t bytes = bytes_of(bvh.nodes) + bytes_of(bvh.blocks) + bytes_of(bvh.instances) +
                        bytes_of(scene.vertices) + bytes_of(scene.vertex_normals) +
                        bytes_of(scene.indices) + bytes_of(scene.triangle_materials) +
                        bytes_of(scene.materials) + bytes_of(scene.lights) +
                        bytes_of(scene.texels) + bytes_of(scene.textures) + bytes_of(scene.maps) +
                        bytes_of(scene.colors) + bytes_of(scene.tangents) +
                        bytes_of(scene.alpha_of) + bytes_of(scene.alpha_triangles);
    for (const auto& set : scene.coordinates) bytes += bytes_of(set);
    const LightCells& cells = scene.light_cells;
    if (find_features(scene).reflections)
        bytes += bytes_of(cells.grid_of) + bytes_of(cells.grids) + bytes_of(cells.lights);
    if (tree) bytes += 2 * sizeof(LightNode) * scene.lights.size();
    return bytes;
}

}  // namespace manylight

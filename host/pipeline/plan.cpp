// SPDX-License-Identifier: MIT
#include "pipeline/plan.hpp"

#include <algorithm>

#include "error.hpp"
#include "pipeline/aov.hpp"
#include "samplers/table.hpp"
#include "stages/accumulate.hpp"
#include "stages/device_scene.hpp"
#include "stages/reflections.hpp"

namespace manylight {
namespace {

constexpr std::size_t items_per_batch = std::size_t{1} << 16;  // whose rays the caches hold
constexpr std::size_t default_budget = std::size_t{2} << 30;

template <class Vector>
std::size_t bytes_of(const Vector& values) {
    return values.size() * sizeof(values[0]);
}

std::string mebibytes(std::size_t bytes) {
    return fmt::format("{:.1f} MiB", static_cast<double>(bytes) / (1 << 20));
}

void check_aovs(const RenderOptions& options, bool clusters) {
    for (const Aov& aov : all_aovs())
        if (aov.needs_clusters && !clusters && std::ranges::count(options.aovs, aov.name))
            throw InputError("--aov {}: sampler {} makes no clusters here", aov.name,
                             options.sampler);
}

std::size_t coordinate_bytes(const Scene& scene) {
    std::size_t bytes = 0;
    for (const auto& set : scene.coordinates) bytes += bytes_of(set);
    return bytes;
}

// Throws unless the device can hold each of the scene's and the image's buffers.
void check_buffers(const DeviceInfo& device, const Scene& scene, const WideBvh& bvh,
                   std::size_t light_tree, std::size_t image) {
    const std::pair<const char*, std::size_t> buffers[] = {
        {"BVH nodes", bytes_of(bvh.nodes)},
        {"triangles", bytes_of(bvh.blocks)},
        {"vertices", bytes_of(scene.vertices)},
        {"indices", bytes_of(scene.indices)},
        {"instances", bytes_of(scene.instances)},
        {"lights", bytes_of(scene.lights)},
        {"light tree", light_tree},
        {"textures", bytes_of(scene.texels)},
        {"texture coordinates", coordinate_bytes(scene)},
        {"image", image}};
    for (const auto& [name, bytes] : buffers)
        if (bytes > device.max_allocation)
            throw InputError("{}: its {} need {}, and {} allows {} at most in a buffer", scene.file,
                             name, mebibytes(bytes), device.name, mebibytes(device.max_allocation));
}

}  // namespace

bool RenderOptions::estimates_error() const {
    return target_error > 0 || std::ranges::count(aovs, "error") > 0;
}

unsigned RenderOptions::tile_size() const {
    const unsigned own = find_sampler(sampler).tile_size;
    return own > 0 ? own : clusters.tile_size;
}

EmitterParts RenderOptions::emitter_parts(const Scene& scene, const Camera& camera) const {
    if (!jitters() || hide_emitters) return {};
    return find_emitter_parts(scene, camera, width, height);
}

Plan make_plan(const DeviceInfo& device, const Scene& scene, const WideBvh& bvh,
               const RenderOptions& options, const EmitterParts& emitters) {
    const Sampler& sampler = find_sampler(options.sampler);
    const ParameterValues parameters = values_of(sampler, options.parameters);
    const unsigned size = options.tile_size();
    const std::size_t tile_items = std::size_t{size} * size;
    const Tiles tiles = all_tiles(options.width, options.height, size);
    const auto lights = static_cast<uint>(scene.lights.size());
    Plan plan;
    if (scene.lights.size() > sampler.most_lights)
        throw InputError("{}: it has {} lights, and sampler {} takes {} at most", scene.file,
                         scene.lights.size(), options.sampler, sampler.most_lights);
    if (options.estimates_error() && options.spp < 2)
        throw InputError("--spp {}: the error is estimated from two or more pixel samples",
                         options.spp);
    plan.clusters = sampler.clusters && lights > 0;
    plan.centres = plan.clusters || std::ranges::any_of(options.aovs, [](const std::string& name) {
                       return name != "error";
                   });
    check_aovs(options, plan.clusters);
    plan.scene_bytes = scene_bytes(scene, bvh, sampler.tree);
    const std::size_t light_tree = sampler.tree ? 2 * sizeof(LightNode) * lights : 0;
    plan.image_bytes = std::size_t{options.width} * options.height *
                           ImageSum::pixel_bytes(options.estimates_error()) +
                       emitters.bytes();
    check_buffers(device, scene, bvh, light_tree,
                  std::size_t{options.width} * options.height * sizeof(float4) *
                      (options.estimates_error() ? ERROR_GROUPS : 1));

    const bool two_surfaces = plan.centres && options.jitters();
    const std::size_t surface_bytes =
        sizeof(Surface) + (scene.varies_materials() ? sizeof(Material) : 0);
    // Nothing is made of a sampler that has no lights to draw.
    const auto footprint = [&](std::size_t batch) {
        if (lights == 0) return Footprint{};
        return sampler.footprint(
            {lights, batch, size, options.most_samples(), options.clusters, parameters});
    };
    const Footprint need = footprint(tiles.count);
    const std::size_t surfaces = two_surfaces ? 2 : 1;
    const bool reflects = options.reflections && find_features(scene).reflections;
    const std::size_t tile_bytes =
        need.tile + tile_items * (surfaces * surface_bytes + 2 * sizeof(float4) +
                                  (emitters.empty() ? 0 : sizeof(float4)) +
                                  (reflects ? ReflectionStage::item_bytes() : 0));
    const std::size_t budget =
        options.memory > 0 ? options.memory : std::min(device.global_memory / 2, default_budget);
    const std::size_t fixed = plan.scene_bytes + plan.image_bytes + need.image + need.fixed;
    if (fixed + tile_bytes > budget)
        throw InputError(
            "--memory: {}{} is too little: the scene needs {}, the image {}, tables and rays in "
            "work {}, and "
            "one tile {}{}",
            mebibytes(budget), options.memory > 0 ? "" : " (the default)",
            mebibytes(plan.scene_bytes), mebibytes(plan.image_bytes),
            mebibytes(need.image + need.fixed), mebibytes(tile_bytes),
            plan.clusters ? " (a smaller --max-depth or --tile-size needs less)" : "");
    if (need.tile_matrix > device.max_allocation)
        throw InputError(
            "{}: one tile's contribution matrix needs {}, and {} allows {} at most in a buffer (a "
            "smaller --max-depth or --tile-size needs less)",
            scene.file, mebibytes(need.tile_matrix), device.name, mebibytes(device.max_allocation));
    std::size_t most = sampler.large_batches
                           ? tiles.count
                           : std::clamp<std::size_t>(items_per_batch / tile_items, 1, tiles.count);
    most = std::min(most, (budget - fixed) / tile_bytes);
    if (need.tile_matrix > 0) most = std::min(most, device.max_allocation / need.tile_matrix);
    const std::size_t largest_buffer = std::max(tile_items * surface_bytes, need.tile_buffer);
    most = std::clamp<std::size_t>(device.max_allocation / largest_buffer, 1, most);
    plan.tiles_per_batch = static_cast<unsigned>(most);
    plan.batches = static_cast<unsigned>((tiles.count + most - 1) / most);
    const Footprint taken = footprint(most);
    plan.matrix_bytes = taken.image + most * taken.tile_matrix;
    plan.sampler_bytes = taken.fixed + taken.image + most * taken.tile;
    plan.point_bytes =
        scene.varies_materials() ? most * tile_items * surfaces * sizeof(Material) : 0;
    plan.batch_bytes = plan.sampler_bytes + most * (tile_bytes - need.tile);
    return plan;
}

}  // namespace manylight

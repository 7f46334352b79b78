// SPDX-License-Identifier: MIT
#include "output/hash.hpp"

#include <OpenImageIO/hash.h>
#include <fmt/format.h>

namespace manylight {

ContentHash& ContentHash::add(std::span<const std::byte> bytes) {
    using OIIO::xxhash::xxhash;
    const std::uint64_t head[] = {state_, bytes.size()};
    const void* start = head;
    state_ =
        xxhash(static_cast<const void*>(bytes.data()), bytes.size(), xxhash(start, sizeof(head)));
    return *this;
}

ContentHash& ContentHash::add(const Scene& scene) {
    const auto add_all = [this](const auto&... values) {
        (add(std::as_bytes(std::span(values))), ...);
    };
    add(scene.origin.x).add(scene.origin.y).add(scene.origin.z);
    add_all(scene.vertices, scene.vertex_normals, scene.indices, scene.triangle_materials);
    add_all(scene.instances, scene.materials, scene.lights, scene.maps, scene.textures);
    add_all(scene.light_cells.grid_of, scene.light_cells.grids, scene.light_cells.lights);
    add_all(scene.texels, scene.colors, scene.tangents, scene.alpha_of, scene.alpha_triangles);
    for (const auto& set : scene.coordinates) add_all(set);
    return *this;
}

std::string ContentHash::name() const { return fmt::format("{:016x}", state_); }

}  // namespace manylight

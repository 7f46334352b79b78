// SPDX-License-Identifier: MIT
#define GLM_ENABLE_EXPERIMENTAL
#include "scene/gltf/instances.hpp"

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtx/component_wise.hpp>

#include "error.hpp"
#include "scene/gltf/model.hpp"

namespace manylight {

Instances::Instances(Loading& in, Storage& storage, MeshReader& meshes)
    : in_(in), storage_(storage), meshes_(meshes) {}

// A skinned mesh is where its joints are, whatever the node.
void Instances::add(int node) {
    const bool skinned = in_.model.nodes[node].skin >= 0;
    const int mesh = in_.model.nodes[node].mesh;
    std::vector<glm::dmat4> places = mesh_instances(in_.file, node, in_.accessors);
    std::size_t copies = 0;
    const glm::dmat4 from_file = glm::translate(glm::dmat4(1), -in_.scene.origin);
    const glm::dmat4 to_file = glm::translate(glm::dmat4(1), in_.scene.origin);
    for (glm::dmat4& place : places) {
        place = skinned ? from_file * place * to_file : in_.pose.to_world(node) * place;
        in_.check_transform(place, node);
        if (storage_.is_shared(mesh) && !can_be_instance(mesh, glm::dmat3(place))) ++copies;
    }
    if (copies > 0) storage_.add_copies(node, copies);  // which nobody has counted yet
    for (const glm::dmat4& place : places) {
        if (!storage_.is_shared(mesh) || !can_be_instance(mesh, glm::dmat3(place))) {
            meshes_.add(node, place);
            continue;
        }
        in_.scene.instances.push_back(make_instance(glm::translate(place, centre_of(node))));
        in_.scene.instances.back().mesh = static_cast<std::uint32_t>(mesh);  // the file's, for now
    }
}

// Of a shared mesh, in its own frame: it is stored about that, for rays are rounded relative to
// an instance's place.
const glm::dvec3& Instances::centre_of(int node) {
    const int mesh = in_.model.nodes[node].mesh;
    const auto [found, is_new] = centres_.try_emplace(mesh, 0.0);
    if (!is_new) return found->second;
    Bounds bounds;
    const auto& primitives = in_.model.meshes[mesh].primitives;
    for (std::size_t p = 0; p < primitives.size(); ++p)
        if (is_rendered(in_.model, primitives[p]))
            for (const glm::vec4& v : in_.accessors.vectors(
                     primitives[p].attributes.at("POSITION"), Attribute::position,
                     fmt::format("meshes[{}].primitives[{}].attributes.POSITION", mesh, p)))
                bounds.add(glm::vec3(v));
    found->second = glm::dvec3(bounds.centre());
    return found->second;
}

// Whether single precision can take rays to a mesh's frame and normals back, and its triangles
// face the same side there, if it matters.
bool Instances::can_be_instance(int mesh, const glm::dmat3& m) const {
    if (glm::determinant(m) < 0 &&
        std::ranges::any_of(in_.model.meshes[mesh].primitives, [&](const auto& primitive) {
            return in_.scene.materials[material_of(in_.model, primitive)].culled != 0;
        }))
        return false;
    const auto norm = [](const glm::dmat3& a) {
        return std::sqrt(glm::dot(a[0], a[0]) + glm::dot(a[1], a[1]) + glm::dot(a[2], a[2]));
    };
    constexpr double most = 100;  // 3 where nothing is distorted
    const glm::dmat3 inverse = glm::inverse(m);
    return norm(m) * norm(inverse) < most && norm(m) < 1e6 && norm(inverse) < 1e6;
}

void Instances::add_shared_meshes() {
    std::vector<std::uint32_t> numbers(in_.model.meshes.size(), ~0u);  // in the scene
    for (const int node : in_.nodes) {
        const int mesh = in_.model.nodes[node].mesh;
        if (mesh < 0 || !centres_.contains(mesh) || numbers[mesh] != ~0u) continue;
        numbers[mesh] = static_cast<std::uint32_t>(in_.scene.shared_meshes.size());
        const std::size_t vertices = in_.scene.vertices.size();
        const std::size_t triangles = in_.scene.triangle_count();
        meshes_.add(node, glm::translate(glm::dmat4(1), -centre_of(node)));
        SharedMesh shared{static_cast<std::uint32_t>(triangles),
                          static_cast<std::uint32_t>(in_.scene.triangle_count() - triangles),
                          static_cast<std::uint32_t>(vertices),
                          static_cast<std::uint32_t>(in_.scene.vertices.size() - vertices),
                          {}};
        for (std::size_t v = vertices; v < in_.scene.vertices.size(); ++v)
            shared.bounds.add(in_.scene.vertices[v]);
        in_.scene.shared_meshes.push_back(shared);
    }
    std::size_t next = in_.scene.triangle_count();
    for (Instance& in : in_.scene.instances) {
        in.mesh = numbers[in.mesh];
        const SharedMesh& shared = in_.scene.shared_meshes[in.mesh];
        in.stored = shared.first_triangle;
        in.first = static_cast<std::uint32_t>(next);
        next += shared.triangle_count;
        if (next >= ~0u)
            throw InputError("{}: more than 2^32 triangles, instances counted one by one",
                             in_.scene.file);
    }
    const Bounds bounds = in_.scene.bounds();
    if (!bounds.empty() && !(std::max(glm::compMax(glm::abs(bounds.lower)),
                                      glm::compMax(glm::abs(bounds.upper))) <= farthest))
        throw InputError("{}: an instance of a mesh is out of range in the world: more than {}",
                         in_.scene.file, farthest);
}

}  // namespace manylight

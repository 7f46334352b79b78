// SPDX-License-Identifier: MIT
#include "scene/gltf/storage.hpp"

#include <unistd.h>

#include <algorithm>

#include "error.hpp"
#include "scene/gltf/model.hpp"

namespace manylight {
namespace {

// What a scene holds of each at the least: a position and a normal; a triangle's corners, material,
// bounds while the BVH is built and place in it.
constexpr double vertex_bytes = 24;
constexpr double triangle_bytes = 96;
constexpr double instance_bytes = 512;       // its node above, too
constexpr double place_bytes = 176;          // of an instance while it is read
constexpr double worth_sharing = 256 << 20;  // bytes of copies
constexpr double most_steps = 4e9;           // a minute or two

}  // namespace

Storage::Storage(const Loading& in) : in_(in) {
    choose_shared();
    count_all();
    check_size();
}

double Storage::Size::bytes() const { return vertices * vertex_bytes + triangles * triangle_bytes; }

std::size_t Storage::bytes_left() const {
    return most_bytes() - static_cast<std::size_t>(needed_bytes());
}

void Storage::add_copies(int node, std::size_t copies) {
    count_copies(node, static_cast<double>(copies));
    check_size();
}

std::size_t Storage::most_bytes() const {
    if (in_.options.most_bytes != 0) return in_.options.most_bytes;
    return static_cast<std::size_t>(sysconf(_SC_PHYS_PAGES)) *
           static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
}

// About how much there is to compute for an instance of a node's mesh.
double Storage::steps_of(int node) const {
    const int skin = in_.model.nodes[node].skin;
    const auto joints = skin < 0 ? 0.0 : static_cast<double>(in_.model.skins[skin].joints.size());
    double steps = 0;
    for (const auto& primitive : in_.model.meshes[in_.model.nodes[node].mesh].primitives) {
        steps += 10 + joints;
        if (is_rendered(in_.model, primitive))
            steps += static_cast<double>(
                         in_.model.accessors[primitive.attributes.at("POSITION")].count) *
                     static_cast<double>(1 + primitive.targets.size());
    }
    return steps;
}

Storage::Size Storage::size_of(int mesh) const {
    Size size;
    for (const auto& primitive : in_.model.meshes[mesh].primitives) {
        if (!is_rendered(in_.model, primitive)) continue;
        const std::size_t count = in_.model.accessors[primitive.attributes.at("POSITION")].count;
        const std::size_t corners =
            primitive.indices < 0 ? count : in_.model.accessors[primitive.indices].count;
        size.vertices += static_cast<double>(count);
        size.triangles += static_cast<double>(is_list(primitive.mode) ? corners / 3 : corners);
    }
    return size;
}

// Whether it is the same wherever it stands, but for the transform, and gives no light.
bool Storage::is_rigid_and_dark(int mesh) const {
    return std::ranges::none_of(
        in_.model.meshes[mesh].primitives, [&](const tinygltf::Primitive& p) {
            const Material& m = in_.scene.materials[material_of(in_.model, p)];
            return !p.targets.empty() || (glm::vec3(m.emission) != glm::vec3(0) && m.unlit == 0);
        });
}

// Which meshes are stored once: those of which copies take more than instances, if all such
// copies together take much.
void Storage::choose_shared() {
    is_shared_.assign(in_.model.meshes.size(), false);
    if (in_.options.storage == MeshStorage::copied) return;
    std::vector<double> places(in_.model.meshes.size(), 0);
    std::vector<bool> skinned(in_.model.meshes.size(), false);
    for (const int node : in_.nodes) {
        const int mesh = in_.model.nodes[node].mesh;
        if (mesh < 0) continue;
        places[mesh] += static_cast<double>(count_instances(in_.file, node));
        if (in_.model.nodes[node].skin >= 0) skinned[mesh] = true;
    }
    std::vector<bool> chosen = is_shared_;
    double all_saved = 0;
    for (std::size_t mesh = 0; mesh < places.size(); ++mesh) {
        if (places[mesh] < 2 || skinned[mesh]) continue;
        const double saved = (places[mesh] - 1) * size_of(static_cast<int>(mesh)).bytes() -
                             places[mesh] * instance_bytes;
        if (saved <= 0 || !is_rigid_and_dark(static_cast<int>(mesh))) continue;
        chosen[mesh] = true;
        all_saved += saved;
    }
    if (in_.options.storage == MeshStorage::shared || all_saved > worth_sharing)
        is_shared_ = chosen;
}

// Finds how much is to be stored and computed: `copies` of a node's mesh.
void Storage::count_copies(int node, double copies) {
    const Size size = size_of(in_.model.nodes[node].mesh);
    stored_.vertices += copies * size.vertices;
    stored_.triangles += copies * size.triangles;
    steps_ += copies * steps_of(node);
}

void Storage::count_all() {
    std::vector<bool> counted(in_.model.meshes.size(), false);
    for (const int node : in_.nodes) {
        const int mesh = in_.model.nodes[node].mesh;
        if (mesh < 0) continue;
        const auto places = static_cast<double>(count_instances(in_.file, node));
        steps_ += places;
        most_places_ = std::max(most_places_, places);
        if (!is_shared_[mesh]) {
            count_copies(node, places);
            continue;
        }
        if (!counted[mesh]) count_copies(node, 1);
        counted[mesh] = true;
        instances_ += places;
    }
    expected_ = stored_.vertices + stored_.triangles;
}

double Storage::needed_bytes() const {
    return stored_.bytes() + instances_ * instance_bytes + most_places_ * place_bytes;
}

// A file of a kilobyte may ask for any number of instances.
void Storage::check_size() const {
    const auto most = static_cast<double>(most_bytes());
    const double bytes = needed_bytes();
    constexpr double gib = 1 << 30;
    if (bytes > most)
        throw InputError(
            "{}: its {:.0f} triangles and {:.0f} instances that share them need at least "
            "{:.1f} GiB, and there are {:.1f} GiB of memory",
            in_.scene.file, stored_.triangles, instances_, bytes / gib, most / gib);
    if (steps_ > most_steps)
        throw InputError(
            "{}: its instances, joints and morph targets make {:.3g} steps to load: more than "
            "{:.3g}",
            in_.scene.file, steps_, most_steps);
}

}  // namespace manylight

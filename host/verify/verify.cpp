// SPDX-License-Identifier: MIT
#include "verify/verify.hpp"

#include <algorithm>
#include <cstring>

#include <glm/gtc/constants.hpp>

#include "reference/random.hpp"
#include "scene/alpha.hpp"
#include "verify/stages.hpp"

namespace manylight {

void Check::compare(double difference, double allowed, const std::string& item, bool zero) {
    ++items;
    if (!zero) ++telling;
    if (difference <= allowed) {
        if (difference > 0) largest = std::max(largest, difference / allowed);
        return;
    }
    largest = std::max(largest, allowed > 0 ? difference / allowed : 1e30);
    if (failed++ == 0) first_failure = item;
}

void Check::skip_borderline() {
    ++items;
    ++borderline;
}

void Check::excuse_agreeing(std::size_t agreeing,
                            const std::function<int(std::size_t)>& undecided) {
    if (passed() || agreeing == 0) return;
    constexpr std::size_t most = 400;
    const std::size_t judged = std::min(agreeing, most);
    const double before = excused;
    for (std::size_t i = 0; i < judged; ++i) excuse(undecided(i * agreeing / judged));
    excused =
        before + (excused - before) * static_cast<double>(agreeing) / static_cast<double>(judged);
}

std::string stage_of(const Check& check) { return check.stage.substr(0, check.stage.find(" (")); }

namespace {

constexpr std::size_t most_matrix_entries = std::size_t{1} << 26;

Tiles choose_tiles(const VerifyOptions& options, std::size_t lights) {
    const std::size_t per_tile = most_regions(options.clusters) * std::max<std::size_t>(lights, 1);
    const auto most = static_cast<uint>(std::max<std::size_t>(most_matrix_entries / per_tile, 1));
    return middle_tiles(options.width, options.height, options.clusters.tile_size, most);
}

// A copy, where the points' materials are to be added. What rays pass by chance is made a mask.
const Scene& copy_to_change(const Scene& scene, std::optional<Scene>& copy) {
    if (!scene.varies_materials() && scene.alpha_of.empty()) return scene;
    copy = scene;
    mask_all_alpha(*copy);
    return *copy;
}

// Where the light of points goes that are no pixels.
DeviceScene with_outgoing(DeviceScene scene, const Buffer<Outgoing>& outgoing, bool receivers) {
    if (receivers) set_outgoing(scene, outgoing);
    return scene;
}

}  // namespace

Verifier::Verifier(Device device, const Scene& scene, const Camera& camera,
                   const VerifyOptions& options)
    : device_(device),
      scene_(copy_to_change(scene, varied_)),
      camera_(camera),
      view_(camera),
      options_(options),
      tiles_(choose_tiles(options, scene.lights.size())),
      reach_(reach_of(scene, camera)),
      bvh_(build_wide_bvh(scene, device.form().bvh_width, device.form().bvh_width, reach_)),
      points_(item_count(all_tiles(options.width, options.height, 128))),
      outgoing_(options.receivers ? device_.allocate<Outgoing>(points_) : Buffer<Outgoing>()),
      device_scene_(with_outgoing(upload_scene(device_, scene_, bvh_, camera, nullptr, 2 * points_),
                                  outgoing_, options.receivers)),
      tree_(build_light_tree(scene.lights)),
      tree_scene_(with_outgoing(upload_scene(device_, scene_, bvh_, camera, &tree_), outgoing_,
                                options.receivers)),
      tracer_(scene_),
      surfaces_(device_.allocate<Surface>(item_count(tiles_))),
      clustering_(device_, device_scene_, options.clusters, tiles_.count) {
    tree_scene_.materials = device_scene_.materials;
    tree_scene_.arguments.set("materials", device_scene_.materials);
    GBufferStage(device_, device_scene_).trace(tiles_, {}, surfaces_);
    keep_materials();
    found_ = surfaces_.download();
    send_out(found_);
    if (scene.lights.empty()) return;
    clustering_.build(tiles_, surfaces_, [](std::size_t) {});
    const std::vector<uint> words =
        clustering_.matrix().values.download(0, clustering_.regions().size() * scene.lights.size());
    matrix_.resize(words.size());
    std::memcpy(matrix_.data(), words.data(), words.size() * sizeof(float));
}

void Verifier::keep_materials() {
    if (varied_) varied_->materials = device_scene_.materials.download();
}

void Verifier::send_out(const std::vector<Surface>& points) {
    if (!options_.receivers) return;
    std::vector<Outgoing> outgoing(points.size());
    for (std::size_t item = 0; item < points.size(); ++item) {
        const auto bits =
            reference::random_bits(static_cast<uint>(item), 0, 0x7fffffffu, options_.seed);
        const auto u = [&](int i) { return reference::unit_fraction(bits[i]); };
        // Half of the way to anywhere on the sphere: on the side of the normal.
        const double z = 2 * u(0) - 1;
        const double radius = 0.5 * std::sqrt(std::max(1 - z * z, 0.0));
        const double phi = 2 * glm::pi<double>() * u(1);
        const glm::dvec3 normal =
            points[item].position.w < 0 ? glm::dvec3(0, 0, 1) : glm::dvec3(points[item].normal);
        const glm::dvec3 direction = glm::normalize(
            normal + glm::dvec3(radius * std::cos(phi), radius * std::sin(phi), 0.5 * z));
        outgoing[item] = {float4(glm::vec3(direction), 0),
                          float4(0.25 + u(2), 0.25 + u(3), 1.25 - u(2), 0)};
    }
    outgoing_.upload(outgoing);
    view_ = reference::Viewers(std::move(outgoing));
}

Buffer<Surface> Verifier::trace(const Tiles& tiles, const PixelSample& sample) {
    Buffer<Surface> surfaces = device_.allocate<Surface>(item_count(tiles));
    GBufferStage(device_, device_scene_).trace(tiles, sample, surfaces, points_);
    keep_materials();
    return surfaces;
}

std::vector<Check> Verifier::all() { return run_stages(*this, selected_stages(options_.only)); }

}  // namespace manylight

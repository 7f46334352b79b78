// SPDX-License-Identifier: MIT
#include "samplers/contribution/clustering.hpp"

#include <cmath>
#include <glm/trigonometric.hpp>

namespace manylight {

unsigned most_regions(const ClusterOptions& options) {
    // Leaves by normals, each split again and again in shadow: at most the whole tree.
    unsigned regions = 0;
    for (unsigned level = 0, size = options.tile_size; level <= options.max_depth && size > 0;
         ++level, size /= 2)
        regions += 1u << (2 * level);
    return regions;
}

std::size_t Clustering::tile_bytes(const ClusterOptions& options, uint light_count) {
    const std::size_t region = sizeof(Region) + 2 * sizeof(uint) + Matrix::row_bytes(light_count);
    return most_regions(options) * region +
           std::size_t{options.tile_size} * options.tile_size * sizeof(uint);
}

Clustering::Clustering(Device& device, const DeviceScene& scene, const ClusterOptions& options,
                       unsigned most_tiles)
    : options_(options),
      cluster_stage_(device),
      representative_stage_(device),
      contribution_stage_(device, scene),
      refinement_stage_(device),
      pdf_stage_(device, scene),
      device_regions_(device.allocate<Region>(std::size_t{most_tiles} * most_regions(options))),
      device_split_(device.allocate<uint>(device_regions_.size())),
      device_representatives_(device.allocate<uint>(device_regions_.size())),
      device_item_rows_(
          device.allocate<uint>(std::size_t{most_tiles} * options.tile_size * options.tile_size)),
      matrix_(device, static_cast<uint>(device_regions_.size()), scene.light_count) {}

void Clustering::build(const Tiles& tiles, const Buffer<Surface>& surfaces,
                       const std::function<void(std::size_t)>& progress) {
    split_by_normals(tiles, surfaces);
    refine(tiles, surfaces, progress);
    cluster_stage_.assign(tiles, device_regions_, static_cast<uint>(regions_.size()), device_split_,
                          device_item_rows_);
}

void Clustering::split_by_normals(const Tiles& tiles, const Buffer<Surface>& surfaces) {
    const float cos_threshold = std::cos(glm::radians(options_.normal_threshold));
    regions_.clear();
    std::vector<Region> level = root_regions(tiles);
    while (!level.empty()) {
        const auto count = static_cast<uint>(level.size());
        device_regions_.upload(level);
        cluster_stage_.split(tiles, surfaces, device_regions_, count, cos_threshold,
                             options_.max_depth, device_split_);
        const std::vector<uint> split = device_split_.download(0, count);
        std::vector<Region> next;
        for (uint i = 0; i < count; ++i) {
            if (!split[i]) {
                regions_.push_back(level[i]);
                continue;
            }
            for (const Region& quarter : quarters(level[i], tiles)) next.push_back(quarter);
        }
        level = std::move(next);
    }
}

void Clustering::refine(const Tiles& tiles, const Buffer<Surface>& surfaces,
                        const std::function<void(std::size_t)>& progress) {
    split_.clear();
    while (split_.size() < regions_.size()) {  // the regions made last have yet to be judged
        const auto first = static_cast<uint>(split_.size());
        const auto count = static_cast<uint>(regions_.size()) - first;
        device_regions_.upload(std::span(regions_).subspan(first), first);
        representative_stage_.pick(tiles, surfaces, device_regions_, first, count,
                                   device_representatives_);
        contribution_stage_.evaluate(surfaces, device_representatives_, first, count, matrix_,
                                     progress);
        refinement_stage_.split(device_regions_, matrix_.totals, first, count, options_.shadow,
                                options_.max_depth, device_split_);
        const std::vector<uint> split = device_split_.download(first, count);
        split_.insert(split_.end(), split.begin(), split.end());
        for (uint i = 0; i < count; ++i) {
            if (!split[i]) continue;
            std::vector<Region> children = quarters(regions_[first + i], tiles);
            for (Region& child : children) {
                child.first_sibling = static_cast<uint>(regions_.size());
                child.siblings = static_cast<uint>(children.size());
            }
            regions_.insert(regions_.end(), children.begin(), children.end());
        }
    }
}

void Clustering::normalise(const Mixture& mixture) {
    pdf_stage_.normalise(static_cast<uint>(regions_.size()), mixture, matrix_);
}

Arguments Clustering::tables() const {
    return Arguments().set("cdf", matrix_.values).set("item_rows", device_item_rows_);
}

Arguments Clustering::clusters() const {
    return Arguments()
        .set("regions", device_regions_)
        .set("representatives", device_representatives_);
}

std::vector<RowSum> Clustering::totals() const {
    return matrix_.totals.download(0, regions_.size());
}

std::vector<uint> Clustering::representatives() const {
    return device_representatives_.download(0, regions_.size());
}

}  // namespace manylight

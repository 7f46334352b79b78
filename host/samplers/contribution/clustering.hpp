// SPDX-License-Identifier: MIT
#pragma once

#include <functional>

#include "samplers/contribution/options.hpp"
#include "stages/clusters.hpp"
#include "stages/contributions.hpp"
#include "stages/pdf.hpp"
#include "stages/refinement.hpp"
#include "stages/representatives.hpp"

namespace manylight {

/// The most regions that a tile's quadtree can come to.
[[nodiscard]] unsigned most_regions(const ClusterOptions& options);

/// The clusters of a batch of tiles, their matrix and their CDFs: the paper's section 4.
class Clustering {
  public:
    /// Holds up to `most_tiles` tiles at a time.
    Clustering(Device& device, const DeviceScene& scene, const ClusterOptions& options,
               unsigned most_tiles);

    /// Clusters the pixels of `tiles` and evaluates every light at every representative.
    void build(const Tiles& tiles, const Buffer<Surface>& surfaces,
               const std::function<void(std::size_t)>& progress);

    /// Turns the matrix to CDFs.
    void normalise(const Mixture& mixture);

    /// The buffers that samplers draw from: cdf, item_rows.
    [[nodiscard]] Arguments tables() const;

    /// What stages read that are made of the clusters: regions, representatives.
    [[nodiscard]] Arguments clusters() const;

    /// Bytes per tile on the device.
    [[nodiscard]] static std::size_t tile_bytes(const ClusterOptions& options, uint light_count);

    // What the last build() made; [region], split ones included.
    [[nodiscard]] const std::vector<Region>& regions() const { return regions_; }
    [[nodiscard]] const std::vector<uint>& split() const { return split_; }
    [[nodiscard]] std::vector<RowSum> totals() const;
    [[nodiscard]] std::vector<uint> representatives() const;
    [[nodiscard]] std::vector<uint> item_rows() const { return device_item_rows_.download(); }
    [[nodiscard]] const Matrix& matrix() const { return matrix_; }

  private:
    void split_by_normals(const Tiles& tiles, const Buffer<Surface>& surfaces);
    void refine(const Tiles& tiles, const Buffer<Surface>& surfaces,
                const std::function<void(std::size_t)>& progress);

    ClusterOptions options_;
    ClusterStage cluster_stage_;
    RepresentativeStage representative_stage_;
    ContributionStage contribution_stage_;
    RefinementStage refinement_stage_;
    PdfStage pdf_stage_;

    std::vector<Region> regions_;
    std::vector<uint> split_;
    Buffer<Region> device_regions_;
    Buffer<uint> device_split_;
    Buffer<uint> device_representatives_;
    Buffer<uint> device_item_rows_;
    Matrix matrix_;
};

}  // namespace manylight

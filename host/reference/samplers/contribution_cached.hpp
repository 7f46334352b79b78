// SPDX-License-Identifier: MIT
// Sampler contribution-cached, step by step: what its kernels compute.
#pragma once

#include <span>
#include <vector>

#include "reference/samples.hpp"
#include "shared/tiles.h"

namespace manylight::reference {

/// A cluster near another one.
struct Neighbour {
    uint row;
    double distance;        // of the representatives, m
    bool doubtful = false;  // rounding may decide whether the normals are similar
};

/// The clusters in the tile of region `row` and the eight about it that are in `tiles`, nearest
/// first, whose representative's normal has a cosine of `least_cosine` or more with its own, or
/// nearly so. `split` and `representatives`: [region]; `surfaces`: [item].
[[nodiscard]] std::vector<Neighbour> neighbours(const Tiles& tiles, std::span<const Region> regions,
                                                std::span<const uint> split,
                                                std::span<const uint> representatives,
                                                std::span<const Surface> surfaces, uint row,
                                                double least_cosine);

/// Draws from the row of the pixel's own cluster and, for the other half of its light samples, from
/// those of the clusters whose representatives are nearest (Georgiev et al., "Importance Caching
/// for Complex Illumination", 2012, with one technique per row and the balance heuristic).
class ContributionCached : public OneLight {
  public:
    struct Tables {
        std::vector<uint> cdf;         // [row * lights + light]
        std::vector<uint> item_rows;   // [item]
        std::vector<uint> neighbours;  // [MOST_NEIGHBOURS * row + i], NO_ROW where there is none
        std::vector<float4> places;    // [row] xyz: of the representative
    };

    /// `most_rows`: that a pixel draws from.
    ContributionCached(Tables tables, uint most_rows)
        : tables_(std::move(tables)), most_rows_(most_rows) {}

    [[nodiscard]] Choice choose(const Point& point, const Draw& draw) const override;
    [[nodiscard]] std::optional<double> probability(const Point& point, std::size_t item,
                                                    uint light) const override;
    [[nodiscard]] std::optional<ExpectedCount> expected_count(const Point& point, std::size_t item,
                                                              uint light,
                                                              uint sample_count) const override;

  private:
    struct Rows {
        std::vector<std::span<const uint>> cdfs;  // of each row
        bool doubtful = false;  // rounding may have chosen others, or reordered them
        [[nodiscard]] double probability(uint light) const;
    };
    [[nodiscard]] Rows rows_of(const Point& point, std::size_t item) const;

    Tables tables_;
    uint most_rows_;
};

}  // namespace manylight::reference

// SPDX-License-Identifier: MIT
#pragma once

#include <utility>
#include <vector>

#include "reference/samples.hpp"

namespace manylight::reference {

/// By the CDF of the cluster that an item is of.
class ByContribution : public OneLight {
  public:
    /// cdf[row * lights + light]: running sums; item_rows[item]: a row.
    ByContribution(std::vector<uint> cdf, std::vector<uint> item_rows)
        : cdf_(std::move(cdf)), item_rows_(std::move(item_rows)) {}
    [[nodiscard]] Choice choose(const Point& point, const Draw& draw) const override;
    [[nodiscard]] std::optional<double> probability(const Point& point, std::size_t item,
                                                    uint light) const override;

  private:
    [[nodiscard]] std::span<const uint> row_of(std::size_t item, std::size_t lights) const;

    std::vector<uint> cdf_;
    std::vector<uint> item_rows_;
};

}  // namespace manylight::reference

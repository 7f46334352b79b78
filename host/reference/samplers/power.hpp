// SPDX-License-Identifier: MIT
#pragma once

#include <utility>
#include <vector>

#include "reference/samples.hpp"

namespace manylight::reference {

/// By one CDF for the whole image.
class ByPower : public OneLight {
  public:
    /// cdf[light]: running sums.
    explicit ByPower(std::vector<uint> cdf) : cdf_(std::move(cdf)) {}
    [[nodiscard]] Choice choose(const Point& point, const Draw& draw) const override;
    [[nodiscard]] std::optional<double> probability(const Point& point, std::size_t item,
                                                    uint light) const override;

  private:
    std::vector<uint> cdf_;
};

}  // namespace manylight::reference

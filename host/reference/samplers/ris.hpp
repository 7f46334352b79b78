// SPDX-License-Identifier: MIT
#pragma once

#include <utility>
#include <vector>

#include "reference/samples.hpp"

namespace manylight::reference {

/// Candidates by power, of which one is drawn by its unshadowed contribution.
class ByCandidates : public OneLight {
  public:
    /// power_cdf[light]: running sums.
    explicit ByCandidates(std::vector<uint> power_cdf) : power_cdf_(std::move(power_cdf)) {}
    [[nodiscard]] Choice choose(const Point& point, const Draw& draw) const override;

  private:
    std::vector<uint> power_cdf_;
};

}  // namespace manylight::reference

// SPDX-License-Identifier: MIT
#pragma once

#include <span>
#include <vector>

#include "shared/contribution.h"
#include "shared/light.h"

namespace manylight::reference {

/// Stage pdf: the probability of each light, from a row's entries and their sums (paper (6),
/// mixed). All 0 where no light has a chance.
[[nodiscard]] std::vector<double> probabilities(std::span<const float> row, const RowSum& total,
                                                std::span<const Light> lights,
                                                const Mixture& mixture);

}  // namespace manylight::reference

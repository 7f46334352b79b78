// SPDX-License-Identifier: MIT
#pragma once

#include "reference/samples.hpp"

namespace manylight::reference {

/// All lights alike.
class Uniform : public OneLight {
  public:
    [[nodiscard]] Choice choose(const Point& point, const Draw& draw) const override;
    [[nodiscard]] std::optional<double> probability(const Point& point, std::size_t item,
                                                    uint light) const override;
};

}  // namespace manylight::reference

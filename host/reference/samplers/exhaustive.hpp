// SPDX-License-Identifier: MIT
#pragma once

#include "reference/samples.hpp"

namespace manylight::reference {

/// Light sample i is light i.
class Exhaustive : public OneLight {
  public:
    [[nodiscard]] Choice choose(const Point& point, const Draw& draw) const override;
};

}  // namespace manylight::reference

// SPDX-License-Identifier: MIT
#include "reference/samplers/power.hpp"

namespace manylight::reference {

Choice ByPower::choose(const Point& /*point*/, const Draw& draw) const {
    return draw_from(cdf_, draw);
}

std::optional<double> ByPower::probability(const Point& /*point*/, std::size_t /*item*/,
                                           uint light) const {
    return share_of(cdf_, light);
}

}  // namespace manylight::reference

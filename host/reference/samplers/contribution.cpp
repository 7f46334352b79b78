// SPDX-License-Identifier: MIT
#include "reference/samplers/contribution.hpp"

namespace manylight::reference {

std::span<const uint> ByContribution::row_of(std::size_t item, std::size_t lights) const {
    return std::span(cdf_).subspan(item_rows_[item] * lights, lights);
}

Choice ByContribution::choose(const Point& /*point*/, const Draw& draw) const {
    return draw_from(row_of(draw.item, draw.light_count), draw);
}

std::optional<double> ByContribution::probability(const Point& point, std::size_t item,
                                                  uint light) const {
    return share_of(row_of(item, point.scene.lights.size()), light);
}

}  // namespace manylight::reference

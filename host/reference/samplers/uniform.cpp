// SPDX-License-Identifier: MIT
#include "reference/samplers/uniform.hpp"

namespace manylight::reference {

Choice Uniform::choose(const Point& /*point*/, const Draw& draw) const {
    return {stratified(draw.light_count, draw.sample, draw.sample_count, draw.bits[0]),
            static_cast<double>(draw.light_count) / draw.sample_count};
}

std::optional<double> Uniform::probability(const Point& point, std::size_t /*item*/,
                                           uint /*light*/) const {
    return 1.0 / static_cast<double>(point.scene.lights.size());
}

}  // namespace manylight::reference

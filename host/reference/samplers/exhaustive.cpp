// SPDX-License-Identifier: MIT
#include "reference/samplers/exhaustive.hpp"

namespace manylight::reference {

Choice Exhaustive::choose(const Point& /*point*/, const Draw& draw) const {
    return {draw.sample, 1};
}

}  // namespace manylight::reference

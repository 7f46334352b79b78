// SPDX-License-Identifier: MIT
#pragma once

#include "output/image.hpp"

namespace manylight {

/// The image, greyed, with each cluster tinted and outlined and its representative as a red dot, as
/// the paper's figure 3 shows them. `layers` holds "cluster" and "representative". Linear, 0 to 1.
[[nodiscard]] Image draw_cluster_map(const Image& image, float exposure,
                                     const std::vector<std::pair<std::string, Image>>& layers);

}  // namespace manylight

// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <vector>

#include "output/image.hpp"
#include "shared/groups.h"
#include "shared/types.h"

namespace manylight {

/// How far an image is from what it converges to, judged by its own samples.
struct ErrorEstimate {
    double relmse = 0;          // as compare_images() defines it
    double standard_error = 0;  // of relmse
    Image pixels;  // R, G, B: what each pixel adds, NaN where none can tell; relmse is their mean

    /// Half the confidence interval of 95%, and its upper end.
    [[nodiscard]] double margin() const { return 1.96 * standard_error; }
    [[nodiscard]] double most() const { return relmse + margin(); }

    /// Whether the image is so noisy that relmse is too low.
    [[nodiscard]] bool is_noise() const { return relmse > 0.1; }
};

/// `groups`: [ERROR_GROUPS * (y * width + x) + group], rgb: the sum over the group's samples of
/// weight x radiance, w: of weights. docs/stopping.md has the formulas. None where no pixel has
/// samples of two groups, or the image is black. A pixel with samples of one group alone is taken
/// to be as noisy, for its weight, as the others are on average; what is no finite number is left
/// out.
[[nodiscard]] std::optional<ErrorEstimate> estimate_error(unsigned width, unsigned height,
                                                          const std::vector<float4>& groups);

}  // namespace manylight

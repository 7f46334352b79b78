// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "output/image.hpp"
#include "shared/types.h"

namespace manylight {

/// How far an image is from what it converges to, judged by its own samples.
struct ErrorEstimate {
    double relmse = 0;          // as compare_images() defines it
    double standard_error = 0;  // of relmse, if pixels were independent
    Image pixels;               // R, G, B: what each pixel adds; relmse is their mean
};

/// `image`: R, G, B; [y * width + x]: `differences`, rgb: the sum over pairs of samples of weight x
/// (first - second), w: the weight of all pairs; `weights`: of all samples. The squared difference
/// of two means is an unbiased estimate of the squared error of their mean, since samples are
/// uncorrelated. What it is divided by is the image itself, not what it converges to: in images
/// that are mostly noise, relmse is too low.
[[nodiscard]] ErrorEstimate estimate_error(const Image& image,
                                           const std::vector<float4>& differences,
                                           const std::vector<float>& weights);

}  // namespace manylight

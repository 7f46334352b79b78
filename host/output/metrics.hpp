// SPDX-License-Identifier: MIT
#pragma once

#include "output/image.hpp"

namespace manylight {

/// How an image differs from a reference; both R, G, B of the same size.
struct Difference {
    double relmse = 0;    // mean of (x - r)^2 / (r^2 + 0.01), the reference's mean luminance at 0.5
    double rmse = 0;      // root of the mean of (x - r)^2, cd/m2
    double bias = 0;      // mean of x over mean of r, minus 1
    std::size_t bad = 0;  // values of x that are no finite numbers; they are left out above
};

/// Throws InputError if the sizes differ; `a` and `b` name the images in messages.
[[nodiscard]] Difference compare_images(const Image& image, const Image& reference,
                                        const std::string& a, const std::string& b);

}  // namespace manylight

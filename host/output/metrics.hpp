// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "output/image.hpp"

namespace manylight {

/// How an image differs from a reference; both R, G, B of the same size. x and r are values of the
/// image and the reference, scaled so that the reference's mean luminance is 0.5.
struct Difference {
    double relmse = 0;            // mean of (x - r)^2 / (r^2 + 0.01)
    double mape = 0;              // mean of |x - r| / (|r| + 0.01)
    double rmse = 0;              // root of the mean of (x - r)^2, cd/m2
    double bias = 0;              // mean luminance over the reference's, minus 1
    double worst_hundredth = 0;   // share of relmse in the worst 1% of pixels, at least one
    double worst_thousandth = 0;  // and in the worst 0.1%
    std::size_t bad = 0;          // values that are no finite numbers; they are left out above
    std::size_t first_bad = 0;    // of them, an index into the image's values
    std::vector<float> pixels;    // [y * width + x]: a pixel's part of relmse, which is their mean
};

/// Throws InputError if the sizes differ, or the reference holds what is no finite number or is
/// black; `a` and `b` name the images in messages.
[[nodiscard]] Difference compare_images(const Image& image, const Image& reference,
                                        const std::string& a, const std::string& b);

/// The mean luminance of R, G, B, cd/m2.
[[nodiscard]] double mean_luminance(const Image& image);

/// "pixel 3, 4, channel G": where a value of an image is.
[[nodiscard]] std::string place_of_value(const Image& image, std::size_t value);

}  // namespace manylight

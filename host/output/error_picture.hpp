// SPDX-License-Identifier: MIT
// Errors as pictures: each pixel's relative squared error as a colour, on a logarithmic scale.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "output/image.hpp"

namespace manylight {

/// The ends of the scale; what is beyond has the end's colour.
constexpr double least_shown_error = 1e-5;
constexpr double largest_shown_error = 10;

/// Errors of one image.
struct ErrorPanel {
    std::string title;
    unsigned width = 0;
    unsigned height = 0;
    std::vector<float> errors;  // [y * width + x], see Difference::pixels
};

/// The colours from one end of the scale to the other: sRGB codes.
[[nodiscard]] std::array<std::array<unsigned char, 3>, 256> error_colors();

/// A picture of panels side by side, with the scale below; linear, to be written at exposure 1.
/// Images narrower than the scale are magnified by whole numbers.
[[nodiscard]] Image draw_error_picture(const std::vector<ErrorPanel>& panels);

}  // namespace manylight

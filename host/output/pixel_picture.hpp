// SPDX-License-Identifier: MIT
#pragma once

#include <glm/vec2.hpp>

#include "output/image.hpp"

namespace manylight {

/// A row of a pixel's picture; shares are 0 to 1.
struct PictureBar {
    std::string label;
    double contribution;  // share of the pixel's light
    double draws;         // share of the pixel's draws
    double noise;         // share of the pixel's variance
};

/// What a pixel's picture shows.
struct PixelPicture {
    glm::uvec2 pixel;                // from the top left
    unsigned tile_size;              // pixels
    std::vector<std::string> lines;  // above the bars
    std::vector<PictureBar> bars;
};

/// The image's pixels round one pixel, magnified and exposed by themselves, with that pixel
/// (yellow) and its tile (grey) outlined, beside a chart of the bars. Linear, 0 to 1. There is no
/// text where OpenImageIO does not find the font DejaVu Sans.
[[nodiscard]] Image draw_pixel_picture(const Image& image, const PixelPicture& picture);

}  // namespace manylight

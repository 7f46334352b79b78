// SPDX-License-Identifier: MIT
#include "output/pixel_picture.hpp"

#include <gtest/gtest.h>

#include <glm/common.hpp>
#include <map>

namespace manylight {
namespace {

// How many pixels of a picture have a colour.
int count(const Image& image, glm::vec3 color) {
    int sum = 0;
    for (unsigned y = 0; y < image.height; ++y)
        for (unsigned x = 0; x < image.width; ++x) {
            const float* rgb = image.at(x, y);
            sum += glm::vec3(rgb[0], rgb[1], rgb[2]) == color;
        }
    return sum;
}

// The lengths of bars of a colour, and in how many rows of pixels each is; letters are shorter.
std::map<int, int> bars(const Image& image, glm::vec3 color) {
    std::map<int, int> lengths;
    for (unsigned y = 0; y < image.height; ++y) {
        int length = 0;
        for (unsigned x = 0; x < image.width; ++x) {
            const float* rgb = image.at(x, y);
            if (glm::vec3(rgb[0], rgb[1], rgb[2]) == color) {
                ++length;
                continue;
            }
            if (length > 20) ++lengths[length];
            length = 0;
        }
    }
    return lengths;
}

using Bars = std::map<int, int>;

constexpr glm::vec3 yellow(1, 0.8f, 0);
constexpr glm::vec3 orange(0.9f, 0.35f, 0.03f);
constexpr glm::vec3 blue(0.06f, 0.3f, 0.8f);

}  // namespace

// One bright pixel in a dark image: it stands magnified inside its yellow outline, wherever it is.
TEST(pixel_picture, shows_the_pixel_in_its_outline) {
    for (const glm::uvec2 size : {glm::uvec2(200, 100), glm::uvec2(70, 20), glm::uvec2(1, 1)})
        for (const glm::uvec2 pixel : {glm::uvec2(0), size - 1u, size / 2u}) {
            Image image(size.x, size.y, {"R", "G", "B"});
            image.at(pixel.x, pixel.y)[1] = 5;
            const Image picture = draw_pixel_picture(image, {pixel, 32, {}, {}});
            // The magnified pixel: green alone, exposed.
            glm::uvec2 lower(~0u);
            glm::uvec2 upper(0);
            for (unsigned y = 0; y < picture.height; ++y)
                for (unsigned x = 0; x < picture.width; ++x) {
                    const float* rgb = picture.at(x, y);
                    if (!(rgb[0] == 0 && rgb[1] > 0.5f)) continue;
                    lower = glm::min(lower, {x, y});
                    upper = glm::max(upper, {x, y});
                }
            ASSERT_EQ(upper - lower, glm::uvec2(9)) << size.x << " " << pixel.x;
            const auto is_yellow = [&](unsigned x, unsigned y) {
                const float* rgb = picture.at(x, y);
                return glm::vec3(rgb[0], rgb[1], rgb[2]) == yellow;
            };
            // Beside it, where the crop does not end.
            const bool beside = is_yellow(lower.x - 1, lower.y) || is_yellow(upper.x + 1, lower.y);
            EXPECT_TRUE(beside);
            EXPECT_LE(count(picture, yellow), 2 * 52);
        }
}

// Bars are as long as their shares, the longest over the chart's whole width.
TEST(pixel_picture, bars_are_as_long_as_shares) {
    const Image image(8, 8, {"R", "G", "B"});
    const Image picture =
        draw_pixel_picture(image, {{1, 1}, 32, {}, {{"", 0.4, 0.1, 0}, {"", 0, 0.2, 1}}});
    EXPECT_EQ(bars(picture, orange), Bars({{300, 10}}));
    EXPECT_EQ(bars(picture, blue), Bars({{75, 10}, {150, 10}}));
}

// A long list makes a high picture.
TEST(pixel_picture, has_room_for_all_bars) {
    const Image image(8, 8, {"R", "G", "B"});
    PixelPicture facts{{1, 1}, 32, {"a", "b"}, {}};
    const unsigned small = draw_pixel_picture(image, facts).height;
    facts.bars.resize(50, {"", 1, 0, 0});
    const Image picture = draw_pixel_picture(image, facts);
    EXPECT_GT(picture.height, small);
    EXPECT_EQ(bars(picture, orange), Bars({{300, 50 * 10}}));
}

}  // namespace manylight

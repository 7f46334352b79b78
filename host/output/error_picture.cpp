// SPDX-License-Identifier: MIT
#include "output/error_picture.hpp"

#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imagebufalgo.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace manylight {
namespace {

namespace algo = OIIO::ImageBufAlgo;

constexpr const char* font = "DejaVuSans";
constexpr int margin = 16;
constexpr int line = 20;
constexpr int scale_width = 256;
constexpr int scale_height = 12;
const std::vector<float> background = {0.015f, 0.015f, 0.018f};
const std::vector<float> text_color = {0.8f, 0.8f, 0.8f};

using Colors = std::array<std::array<unsigned char, 3>, 256>;

void write(OIIO::ImageBuf& out, int x, int y, const std::string& text) {
    if (!algo::render_text(out, x, y, text, 13, font, text_color)) (void)out.geterror();
}

std::size_t color_of(double error) {
    const double share =
        std::log(error / least_shown_error) / std::log(largest_shown_error / least_shown_error);
    return static_cast<std::size_t>(std::lround(255 * std::clamp(share, 0.0, 1.0)));
}

void set_pixel(Image& out, int x, int y, const std::array<unsigned char, 3>& color) {
    for (int c = 0; c < 3; ++c)
        out.at(x, y)[c] = linear_from_srgb(static_cast<float>(color[c]) / 255);
}

void draw_scale(Image& out, OIIO::ImageBuf& canvas, int x, int y, const Colors& colors) {
    for (int i = 0; i < scale_width; ++i)
        for (int row = 0; row < scale_height; ++row) set_pixel(out, x + i, y + row, colors[i]);
    const double decades = std::log10(largest_shown_error / least_shown_error);
    for (int i = 0; i <= std::lround(decades); i += 2)
        write(canvas, x + static_cast<int>(i * (scale_width - 1) / decades) - 8,
              y + scale_height + line - 6,
              fmt::format("{:g}", least_shown_error * std::pow(10, i)));
}

}  // namespace

Colors error_colors() {
    OIIO::ImageBuf ramp(OIIO::ImageSpec(256, 1, 1, OIIO::TypeDesc::FLOAT));
    for (int i = 0; i < 256; ++i) {
        const float value = static_cast<float>(i) / 255;
        ramp.setpixel(i, 0, &value, 1);
    }
    const OIIO::ImageBuf mapped = algo::color_map(ramp, 0, "inferno");
    Colors out{};
    for (int i = 0; i < 256; ++i) {
        float color[3] = {};
        mapped.getpixel(i, 0, color, 3);
        for (int c = 0; c < 3; ++c)
            out[i][c] =
                static_cast<unsigned char>(std::lround(255 * std::clamp(color[c], 0.f, 1.f)));
    }
    return out;
}

Image draw_error_picture(const std::vector<ErrorPanel>& panels) {
    const Colors colors = error_colors();
    const auto factor = [](const ErrorPanel& p) {
        return std::max(1, static_cast<int>((scale_width + p.width - 1) / p.width));
    };
    int width = margin;
    int tallest = 0;
    for (const ErrorPanel& p : panels) {
        width += static_cast<int>(p.width) * factor(p) + margin;
        tallest = std::max(tallest, static_cast<int>(p.height) * factor(p));
    }
    Image out(width, 4 * margin + 3 * line + tallest + scale_height, {"R", "G", "B"});
    OIIO::ImageBuf canvas(
        OIIO::ImageSpec(width, static_cast<int>(out.height), 3, OIIO::TypeDesc::FLOAT),
        out.values.data());
    algo::fill(canvas, background);
    int left = margin;
    for (const ErrorPanel& p : panels) {
        write(canvas, left, margin + line - 6, p.title);
        const int by = factor(p);
        for (int y = 0; y < static_cast<int>(p.height) * by; ++y)
            for (int x = 0; x < static_cast<int>(p.width) * by; ++x)
                set_pixel(out, left + x, margin + line + y,
                          colors[color_of(p.errors[std::size_t{p.width} * (y / by) + x / by])]);
        left += static_cast<int>(p.width) * by + margin;
    }
    const int y = 2 * margin + line + tallest;
    write(canvas, margin, y + line - 6, "squared relative error of a pixel");
    draw_scale(out, canvas, margin + 8, y + line, colors);
    return out;
}

}  // namespace manylight

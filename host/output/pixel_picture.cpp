// SPDX-License-Identifier: MIT
#include "output/pixel_picture.hpp"

#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imagebufalgo.h>
#include <fmt/format.h>

#include <algorithm>
#include <glm/common.hpp>

namespace manylight {
namespace {

namespace algo = OIIO::ImageBufAlgo;

constexpr const char* font = "DejaVuSans";
constexpr int shown = 64;      // pixels of the crop's side
constexpr int magnified = 10;  // pixels of the picture for one of the image
constexpr int crop = shown * magnified;
constexpr int margin = 16;
constexpr int line = 20;
constexpr int row = 30;
constexpr int label_width = 210;
constexpr int bar_width = 300;
constexpr int value_width = 50;
constexpr int noise_width = 90;
constexpr int chart = label_width + bar_width + value_width + noise_width;

using Color = std::vector<float>;
const Color background = {0.015f, 0.015f, 0.018f};
const Color text_color = {0.8f, 0.8f, 0.8f};
const Color grey = {0.5f, 0.5f, 0.5f};
const Color yellow = {1, 0.8f, 0};
const Color orange = {0.9f, 0.35f, 0.03f};  // the truth
const Color blue = {0.06f, 0.3f, 0.8f};     // the draws
const Color red = {0.9f, 0.08f, 0.06f};     // the noise

// A box's outline, grown by `by`; corners are inside.
void outline(OIIO::ImageBuf& out, glm::ivec2 from, glm::ivec2 to, int by, const Color& color) {
    algo::render_box(out, from.x - by, from.y - by, to.x + by, to.y + by, color, false);
}

void write(OIIO::ImageBuf& out, int x, int y, const std::string& text, const Color& color,
           int size = 13) {
    if (!algo::render_text(out, x, y, text, size, font, color)) (void)out.geterror();
}

void draw_crop(OIIO::ImageBuf& out, const Image& image, const PixelPicture& picture) {
    // Centred on the pixel, but within the image where that is large enough.
    const glm::ivec2 size(image.width, image.height);
    const glm::ivec2 most = glm::max(size - shown, glm::ivec2(0));
    const glm::ivec2 first = glm::clamp(glm::ivec2(picture.pixel) - shown / 2, glm::ivec2(0), most);
    const glm::ivec2 part = glm::min(size - first, glm::ivec2(shown));
    Image pixels(part.x, part.y, {"R", "G", "B"});
    for (int y = 0; y < part.y; ++y)
        std::copy_n(image.at(first.x, first.y + y), 3 * part.x, pixels.at(0, y));
    const float exposure = auto_exposure(pixels);
    for (float& value : pixels.values) value = std::clamp(exposure * value, 0.0f, 1.0f);
    for (int y = 0; y < part.y * magnified; ++y)
        for (int x = 0; x < part.x * magnified; ++x)
            out.setpixel(x, y, pixels.at(x / magnified, y / magnified), 3);
    const auto corner = [&](const glm::ivec2& at) { return (at - first) * magnified; };
    const auto tile_size = static_cast<int>(picture.tile_size);
    const glm::ivec2 tile = glm::ivec2(picture.pixel) / tile_size * tile_size;
    outline(out, corner(tile), corner(tile + tile_size) - 1, 1, grey);
    const glm::ivec2 own(picture.pixel);
    for (const int by : {1, 2}) outline(out, corner(own), corner(own + 1) - 1, by, yellow);
    outline(out, corner(own), corner(own + 1) - 1, 3, {0, 0, 0});
}

void draw_bars(OIIO::ImageBuf& out, int x, int y, const std::vector<PictureBar>& bars) {
    double largest = 0;
    for (const PictureBar& bar : bars) largest = std::max({largest, bar.contribution, bar.draws});
    for (const PictureBar& bar : bars) {
        write(out, x, y + 17, bar.label, text_color);
        write(out, x + chart - noise_width, y + 17, fmt::format("{:.1f}%", 100 * bar.noise), red);
        int top = y + 3;
        for (const auto& [share, color] :
             {std::pair{bar.contribution, &orange}, std::pair{bar.draws, &blue}}) {
            const int left = x + label_width;
            const int length = largest > 0 ? static_cast<int>(bar_width * share / largest) : 0;
            if (length > 0)
                algo::render_box(out, left, top, left + length - 1, top + 9, *color, true);
            write(out, left + length + 6, top + 9, fmt::format("{:.1f}%", 100 * share), *color, 10);
            top += 11;
        }
        y += row;
    }
}

}  // namespace

Image draw_pixel_picture(const Image& image, const PixelPicture& picture) {
    const int width = crop + 3 * margin + chart;
    const int text_bottom = margin + line * static_cast<int>(picture.lines.size());
    const int chart_bottom =
        text_bottom + 2 * line + row * static_cast<int>(picture.bars.size()) + margin;
    const int height = std::max(crop + 2 * margin, chart_bottom);
    Image out(width, height, {"R", "G", "B"});
    const OIIO::ImageSpec spec(width, height, 3, OIIO::TypeDesc::FLOAT);
    OIIO::ImageBuf canvas(spec, out.values.data());
    algo::fill(canvas, background);
    // A picture of its own, so that outlines end at its edge.
    OIIO::ImageBuf cropped(OIIO::ImageSpec(crop, crop, 3, OIIO::TypeDesc::FLOAT));
    draw_crop(cropped, image, picture);
    algo::paste(canvas, margin, margin, 0, 0, cropped);
    const int x = crop + 2 * margin;
    int y = margin;
    for (const std::string& text : picture.lines) write(canvas, x, y += line, text, text_color);
    if (!picture.bars.empty()) {
        write(canvas, x + label_width, y += line, "share of the pixel's light", orange);
        write(canvas, x + label_width + 180, y, "of its draws", blue);
        write(canvas, x + chart - noise_width, y, "of its noise", red);
        draw_bars(canvas, x, y + line / 2, picture.bars);
    }
    return out;
}

}  // namespace manylight

// SPDX-License-Identifier: MIT
// Images in memory and in files. Only host/output/ knows OpenImageIO.
#pragma once

#include <glm/vec3.hpp>
#include <map>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace manylight {

/// width x height pixels of `channels.size()` floats, rows from the top.
struct Image {
    unsigned width = 0;
    unsigned height = 0;
    std::vector<std::string> channels;  // names, as in the file
    std::vector<float> values;          // [(y * width + x) * channels.size() + channel]

    Image() = default;
    Image(unsigned w, unsigned h, std::vector<std::string> names)
        : width(w),
          height(h),
          channels(std::move(names)),
          values(std::size_t{w} * h * channels.size(), 0.0f) {}
    [[nodiscard]] std::size_t pixel_count() const { return std::size_t{width} * height; }
    [[nodiscard]] float* at(unsigned x, unsigned y) {
        return values.data() + (std::size_t{y} * width + x) * channels.size();
    }
    [[nodiscard]] const float* at(unsigned x, unsigned y) const {
        return values.data() + (std::size_t{y} * width + x) * channels.size();
    }
};

/// Facts for a file's header.
using Metadata = std::map<std::string, std::variant<int, float, std::string>>;

/// Writes layers side by side to an OpenEXR file of 32-bit floats (see write_file). Throws
/// RuntimeError.
void write_exr(const std::string& path, const std::vector<Image>& layers, const Metadata& metadata);

/// Writes the first three channels, times `scale`, as an 8-bit sRGB PNG, in the same way; all facts
/// as text.
void write_png(const std::string& path, const Image& image, float scale, const Metadata& metadata);

/// An image in 5 bytes per pixel, planes one after another: [plane * pixels + y * width + x].
/// Planes R, G, B and e are Radiance's RGBE: a value's size is its code x 2^(e - 136). Bit c of the
/// fifth plane is set where channel c is negative, as noise may be. What is no number becomes 0.
struct PackedImage {
    unsigned width = 0;
    unsigned height = 0;
    std::vector<unsigned char> planes;
};

[[nodiscard]] PackedImage pack(const Image& image);
[[nodiscard]] Image unpack(const PackedImage& packed);

/// A grey PNG of all planes, one below another, as a data URI. (Not as channels of one pixel: a
/// browser multiplies colours with alpha.)
[[nodiscard]] std::string data_uri(const PackedImage& packed);

/// The scale that brings the 90th percentile of the luminances of `image` that are not 0 to 0.7.
[[nodiscard]] float auto_exposure(const Image& image);

/// A linear value of an sRGB code, both 0 to 1 (IEC 61966-2-1).
[[nodiscard]] float linear_from_srgb(float code);

/// The channels R, G, B of an image file, linear: integers are taken for sRGB codes. Throws
/// InputError.
[[nodiscard]] Image read_rgb(const std::string& path);

/// The facts of an image file's header whose names start with "manylight:", without that, as text.
/// Throws InputError.
[[nodiscard]] std::map<std::string, std::string> read_facts(const std::string& path);

/// Any channels of an image file, by name, likewise; and of `texts`, names of header facts, the
/// values, empty where there are none.
[[nodiscard]] Image read_channels(const std::string& path, const std::vector<std::string>& channels,
                                  std::map<std::string, std::string>& texts);

}  // namespace manylight

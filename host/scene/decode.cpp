// SPDX-License-Identifier: MIT
#include "scene/decode.hpp"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <string_view>

#include "error.hpp"

namespace manylight {
namespace {

// The name that makes OpenImageIO choose the format of these first bytes; empty: none of ours.
std::string name_for(std::span<const unsigned char> bytes) {
    const std::string_view head(reinterpret_cast<const char*>(bytes.data()),
                                std::min<std::size_t>(bytes.size(), 12));
    if (head.starts_with("\x89PNG")) return "texture.png";
    if (head.starts_with("\xff\xd8\xff")) return "texture.jpg";
    if (head.starts_with("RIFF") && head.substr(8) == "WEBP") return "texture.webp";
    if (head.starts_with("\x76\x2f\x31\x01")) return "texture.exr";
    return {};
}

// libpng tells its errors to standard error itself, beside those that it returns.
class NoStandardError {
  public:
    NoStandardError() : before_(dup(STDERR_FILENO)) {
        const int nowhere = open("/dev/null", O_WRONLY | O_CLOEXEC);
        std::fflush(stderr);
        if (before_ >= 0 && nowhere >= 0) dup2(nowhere, STDERR_FILENO);
        if (nowhere >= 0) close(nowhere);
    }
    ~NoStandardError() {
        if (before_ < 0) return;
        dup2(before_, STDERR_FILENO);
        close(before_);
    }
    NoStandardError(const NoStandardError&) = delete;
    NoStandardError& operator=(const NoStandardError&) = delete;

  private:
    int before_;
};

std::string one_line(std::string text) {
    std::ranges::replace(text, '\n', ' ');
    return text.empty() ? "no reason given" : text.substr(0, 200);
}

void check_size(const OIIO::ImageSpec& spec, const std::string& where) {
    if (spec.width < 1 || spec.height < 1 || spec.depth > 1 || spec.deep)
        throw InputError("{}: {} x {} x {} texels are no flat image", where, spec.width,
                         spec.height, spec.depth);
    if (static_cast<unsigned>(std::max(spec.width, spec.height)) > most_texels_along_side ||
        static_cast<std::size_t>(spec.width) * static_cast<std::size_t>(spec.height) > most_texels)
        throw InputError("{}: {} x {} texels are more than {} along a side or {} in all", where,
                         spec.width, spec.height, most_texels_along_side, most_texels);
    if (spec.nchannels < 1 || spec.nchannels > 4)
        throw InputError("{}: {} channels; there are 1 to 4", where, spec.nchannels);
}

// RGBA of 1 to 4 channels: grey, grey and alpha, RGB, RGBA.
template <class T>
std::vector<T> spread(const std::vector<T>& in, std::size_t channels, T one) {
    if (channels == 4) return in;
    std::vector<T> out(in.size() / channels * 4, one);
    for (std::size_t i = 0; i < in.size() / channels; ++i) {
        const T* texel = &in[i * channels];
        for (std::size_t c = 0; c < 3; ++c) out[4 * i + c] = texel[channels < 3 ? 0 : c];
        if (channels == 2) out[4 * i + 3] = texel[1];
    }
    return out;
}

// What OpenImageIO's readers of some formats do to the colours though they are asked not to.
template <class T>
void divide_by_alpha(std::vector<T>& texels, float one) {
    for (std::size_t i = 0; i < texels.size(); i += 4) {
        const float alpha = static_cast<float>(texels[i + 3]) / one;
        if (!(alpha > 0)) continue;
        for (std::size_t c = 0; c < 3; ++c) {
            const float color = static_cast<float>(texels[i + c]) / alpha;
            if constexpr (std::is_floating_point_v<T>)
                texels[i + c] = color;
            else
                texels[i + c] = static_cast<T>(std::min(std::round(color), one));
        }
    }
}

template <class T>
std::vector<T> read(OIIO::ImageInput& input, const std::string& where, T one) {
    const OIIO::ImageSpec& spec = input.spec();
    const auto channels = static_cast<std::size_t>(spec.nchannels);
    std::vector<T> texels(spec.image_pixels() * channels);
    if (!input.read_image(0, 0, 0, -1, OIIO::TypeDescFromC<T>::value(), texels.data()))
        throw InputError("{}: cannot be decoded: {}", where, one_line(input.geterror()));
    return spread(texels, channels, one);
}

// OpenImageIO 2.4 reads beyond an EXIF chunk of less than 6 bytes, and leaves texels of an
// animation's frame that is smaller than its canvas undefined. Source: the WebP container
// specification.
void check_webp(std::span<const unsigned char> bytes, const std::string& where) {
    const auto word = [&](std::size_t at) {
        return bytes[at] | bytes[at + 1] << 8 | bytes[at + 2] << 16 |
               static_cast<std::uint32_t>(bytes[at + 3]) << 24;
    };
    for (std::size_t at = 12; at + 8 <= bytes.size();) {
        const std::string_view name(reinterpret_cast<const char*>(&bytes[at]), 4);
        const std::size_t length = word(at + 4);
        if (name == "EXIF" && length < 6)
            throw InputError("{}: its EXIF chunk of {} bytes is none", where, length);
        if (name == "VP8X" && at + 8 < bytes.size() && (bytes[at + 8] & 2) != 0)
            throw InputError("{}: it is an animation, which no texture is", where);
        at += 8 + length + length % 2;
    }
}

}  // namespace

DecodedImage decode_image(std::span<const unsigned char> bytes, const std::string& where) {
    const std::string name = name_for(bytes);
    if (name.empty())
        throw InputError("{}: its {} bytes are no PNG, JPEG, WebP or OpenEXR image", where,
                         bytes.size());
    if (name.ends_with(".webp")) check_webp(bytes, where);
    OIIO::Filesystem::IOMemReader reader(bytes.data(), bytes.size());
    OIIO::Filesystem::IOProxy* proxy = &reader;
    const NoStandardError quiet;
    OIIO::ImageSpec config;
    config["oiio:UnassociatedAlpha"] = 1;
    config.attribute("oiio:ioproxy", OIIO::TypeDesc::PTR, &proxy);
    const auto input = OIIO::ImageInput::create(name, false, &config, proxy);
    OIIO::ImageSpec spec;
    if (!input || !input->open(name, spec, config))
        throw InputError("{}: cannot be decoded: {}", where,
                         one_line(input ? input->geterror() : OIIO::geterror()));
    check_size(spec, where);
    DecodedImage out;
    out.width = static_cast<unsigned>(spec.width);
    out.height = static_cast<unsigned>(spec.height);
    const bool exr = name.ends_with(".exr");
    const bool associated = exr || name.ends_with(".webp");
    out.linear = exr;
    if (spec.format == OIIO::TypeDesc::UINT8) {
        out.bytes = read<std::uint8_t>(*input, where, 255);
        if (associated) divide_by_alpha(out.bytes, 255);
    } else {
        out.floats = read<float>(*input, where, 1);
        if (associated) divide_by_alpha(out.floats, 1);
    }
    return out;
}

}  // namespace manylight

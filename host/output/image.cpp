// SPDX-License-Identifier: MIT
#include "output/image.hpp"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <OpenImageIO/strutil.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "error.hpp"
#include "output/write_file.hpp"

namespace manylight {
namespace {

void set_metadata(OIIO::ImageSpec& spec, const Metadata& metadata) {
    for (const auto& [name, value] : metadata)
        std::visit([&, &key = name](const auto& v) { spec.attribute(key, v); }, value);
}

// In memory: a writer that meets a full disk may not say so, write_file() does. The path's ending
// says how.
std::vector<unsigned char> encode(const std::string& path, const OIIO::ImageSpec& spec,
                                  OIIO::TypeDesc type, const void* pixels) {
    std::vector<unsigned char> bytes;
    OIIO::Filesystem::IOVecOutput proxy(bytes);
    const std::unique_ptr<OIIO::ImageOutput> out = OIIO::ImageOutput::create(path);
    if (!out) throw RuntimeError("{}: cannot be encoded: {}", path, OIIO::geterror());
    if (!out->set_ioproxy(&proxy) || !out->open(path, spec) || !out->write_image(type, pixels) ||
        !out->close())
        throw RuntimeError("{}: cannot be encoded: {}", path, out->geterror());
    return bytes;
}

void encode_and_write(const std::string& path, const OIIO::ImageSpec& spec, OIIO::TypeDesc type,
                      const void* pixels) {
    const std::vector<unsigned char> bytes = encode(path, spec, type, pixels);
    write_file(path, std::as_bytes(std::span(bytes)));
}

// IEC 61966-2-1.
float srgb_from_linear(float linear) {
    return linear <= 0.0031308f ? 12.92f * linear : 1.055f * std::pow(linear, 1 / 2.4f) - 0.055f;
}

// The names of a file's channels, for messages.
std::string list_channels(const OIIO::ImageSpec& spec) {
    std::string names;
    for (const std::string& name : spec.channelnames) names += (names.empty() ? "" : ", ") + name;
    return names;
}

// A library's message in one line.
std::string one_line(std::string text) {
    for (char& c : text)
        if (c == '\n') c = ' ';
    return text;
}

}  // namespace

float linear_from_srgb(float code) {
    return code <= 0.04045f ? code / 12.92f : std::pow((code + 0.055f) / 1.055f, 2.4f);
}

void write_exr(const std::string& path, const std::vector<Image>& layers,
               const Metadata& metadata) {
    std::size_t channels = 0;
    for (const Image& layer : layers) channels += layer.channels.size();
    OIIO::ImageSpec spec(static_cast<int>(layers[0].width), static_cast<int>(layers[0].height),
                         static_cast<int>(channels), OIIO::TypeDesc::FLOAT);
    spec.channelnames.clear();
    std::vector<float> pixels(layers[0].pixel_count() * channels);
    std::size_t first = 0;
    for (const Image& layer : layers) {
        const std::size_t count = layer.channels.size();
        spec.channelnames.insert(spec.channelnames.end(), layer.channels.begin(),
                                 layer.channels.end());
        for (std::size_t i = 0; i < layer.pixel_count(); ++i)
            std::copy_n(layer.values.data() + i * count, count,
                        pixels.data() + i * channels + first);
        first += count;
    }
    spec.attribute("compression", "zip");
    set_metadata(spec, metadata);
    encode_and_write(path, spec, OIIO::TypeDesc::FLOAT, pixels.data());
}

void write_png(const std::string& path, const Image& image, float scale, const Metadata& metadata) {
    OIIO::ImageSpec spec(static_cast<int>(image.width), static_cast<int>(image.height), 3,
                         OIIO::TypeDesc::UINT8);
    spec.attribute("oiio:ColorSpace", "sRGB");
    for (const auto& [name, value] : metadata)
        spec.attribute(name, std::visit([](const auto& v) { return fmt::format("{}", v); }, value));
    std::vector<unsigned char> pixels(image.pixel_count() * 3);
    for (std::size_t i = 0; i < image.pixel_count(); ++i)
        for (std::size_t c = 0; c < 3; ++c) {
            const float value = image.values[i * image.channels.size() + c] * scale;
            // NaN compares false: black.
            const float linear = value > 0 ? std::min(value, 1.0f) : 0.0f;
            pixels[3 * i + c] =
                static_cast<unsigned char>(std::lround(255 * srgb_from_linear(linear)));
        }
    encode_and_write(path, spec, OIIO::TypeDesc::UINT8, pixels.data());
}

float auto_exposure(const Image& image) {
    std::vector<float> values;
    for (std::size_t i = 0; i < image.pixel_count(); ++i) {
        const float* p = image.values.data() + i * image.channels.size();
        const float luminance = 0.2126f * p[0] + 0.7152f * p[1] + 0.0722f * p[2];
        if (luminance > 0) values.push_back(luminance);
    }
    if (values.empty()) return 1;
    const auto nth = values.begin() + static_cast<std::ptrdiff_t>(values.size() * 9 / 10);
    std::nth_element(values.begin(), nth, values.end());
    return 0.7f / *nth;
}

PackedImage pack(const Image& image) {
    const std::size_t count = image.pixel_count();
    PackedImage out{image.width, image.height, std::vector<unsigned char>(5 * count)};
    for (std::size_t i = 0; i < count; ++i) {
        const float* p = image.values.data() + 3 * i;
        const float largest = std::max({std::abs(p[0]), std::abs(p[1]), std::abs(p[2])});
        if (!(largest > 1e-36f) || !std::isfinite(p[0] + p[1] + p[2])) continue;
        int exponent = 0;
        // The largest code may be rounded up to 256.
        if (std::lround(256 * std::frexp(largest, &exponent)) == 256) ++exponent;
        for (int c = 0; c < 3; ++c) {
            out.planes[c * count + i] =
                static_cast<unsigned char>(std::lround(std::ldexp(std::abs(p[c]), 8 - exponent)));
            if (p[c] < 0) out.planes[4 * count + i] |= 1 << c;
        }
        out.planes[3 * count + i] = static_cast<unsigned char>(exponent + 128);
    }
    return out;
}

Image unpack(const PackedImage& packed) {
    Image out(packed.width, packed.height, {"R", "G", "B"});
    const std::size_t count = out.pixel_count();
    for (std::size_t i = 0; i < count; ++i)
        for (int c = 0; c < 3; ++c) {
            const float size = std::ldexp(static_cast<float>(packed.planes[c * count + i]),
                                          packed.planes[3 * count + i] - 136);
            out.values[3 * i + c] = (packed.planes[4 * count + i] >> c & 1) != 0 ? -size : size;
        }
    return out;
}

std::string data_uri(const PackedImage& packed) {
    const OIIO::ImageSpec spec(static_cast<int>(packed.width), static_cast<int>(5 * packed.height),
                               1, OIIO::TypeDesc::UINT8);
    const std::vector<unsigned char> png =
        encode("planes.png", spec, OIIO::TypeDesc::UINT8, packed.planes.data());
    return "data:image/png;base64," +
           OIIO::Strutil::base64_encode({reinterpret_cast<const char*>(png.data()), png.size()});
}

std::map<std::string, std::string> read_facts(const std::string& path) {
    const std::unique_ptr<OIIO::ImageInput> in = OIIO::ImageInput::open(path);
    if (!in) throw InputError("{}: cannot be read: {}", path, one_line(OIIO::geterror()));
    constexpr std::string_view prefix = "manylight:";
    std::map<std::string, std::string> facts;
    for (const OIIO::ParamValue& attribute : in->spec().extra_attribs) {
        const std::string name = attribute.name().string();
        if (name.starts_with(prefix)) facts[name.substr(prefix.size())] = attribute.get_string();
    }
    return facts;
}

Image read_rgb(const std::string& path) {
    std::map<std::string, std::string> none;
    return read_channels(path, {"R", "G", "B"}, none);
}

Image read_channels(const std::string& path, const std::vector<std::string>& channels,
                    std::map<std::string, std::string>& texts) {
    const std::unique_ptr<OIIO::ImageInput> in = OIIO::ImageInput::open(path);
    if (!in) throw InputError("{}: cannot be read: {}", path, one_line(OIIO::geterror()));
    const OIIO::ImageSpec& spec = in->spec();
    if (spec.deep) throw InputError("{}: is a deep image, which has no one value per pixel", path);
    std::vector<float> pixels(std::size_t{static_cast<unsigned>(spec.width)} * spec.height *
                              spec.nchannels);
    if (!in->read_image(0, 0, 0, -1, OIIO::TypeDesc::FLOAT, pixels.data()))
        throw InputError("{}: cannot be read: {}", path, one_line(in->geterror()));
    Image image(spec.width, spec.height, channels);
    for (std::size_t c = 0; c < channels.size(); ++c) {
        const int channel = spec.channelindex(image.channels[c]);
        if (channel < 0)
            throw InputError("{}: has no channel {} (its channels: {})", path, image.channels[c],
                             list_channels(spec));
        for (std::size_t i = 0; i < image.pixel_count(); ++i)
            image.values[channels.size() * i + c] = pixels[i * spec.nchannels + channel];
    }
    if (!spec.format.is_floating_point()) {  // codes for a screen
        for (float& value : image.values) value = linear_from_srgb(value);
    }
    for (auto& [name, value] : texts) value = spec.get_string_attribute(name);
    return image;
}

}  // namespace manylight

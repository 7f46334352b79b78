// SPDX-License-Identifier: MIT
#include "output/image.hpp"

#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imagebufalgo.h>
#include <OpenImageIO/imageio.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "error.hpp"

namespace manylight {
namespace {

namespace fs = std::filesystem;

void set_metadata(OIIO::ImageSpec& spec, const Metadata& metadata) {
    for (const auto& [name, value] : metadata)
        std::visit([&, &key = name](const auto& v) { spec.attribute(key, v); }, value);
}

// Writes to a name of its own in the same folder and renames: the old file stays whole until the
// new one is.
void write_aside(const std::string& path, const OIIO::ImageSpec& spec, OIIO::TypeDesc type,
                 const void* pixels) {
    const fs::path target(path);
    const fs::path aside =
        target.parent_path() /
        fmt::format(".{}-{}{}", target.stem().string(), getpid(), target.extension().string());
    std::string problem;
    const std::unique_ptr<OIIO::ImageOutput> out = OIIO::ImageOutput::create(aside.string());
    if (!out || !out->open(aside.string(), spec) || !out->write_image(type, pixels) ||
        !out->close())
        problem = out && out->has_error() ? out->geterror() : OIIO::geterror();
    std::error_code error;
    if (problem.empty() && fs::file_size(aside, error) > 0 && !error) {
        fs::rename(aside, target, error);
        if (!error) return;
    }
    if (problem.empty()) problem = error ? error.message() : "the file stays empty";
    fs::remove(aside, error);
    throw RuntimeError("{}: cannot be written: {}", path, problem);
}

}  // namespace

void check_output(const std::string& path) {
    const fs::path target(path);
    std::string extension = target.extension().string();
    if (extension != ".exr" && extension != ".png")
        throw InputError("--output {}: the name must end in .exr or .png", path);
    const fs::path folder = target.has_parent_path() ? target.parent_path() : fs::path(".");
    std::error_code error;
    if (!fs::is_directory(folder, error))
        throw InputError("--output {}: there is no folder {}", path, folder.string());
    if (access(folder.c_str(), W_OK) != 0)
        throw InputError("--output {}: the folder {} cannot be written", path, folder.string());
    if (fs::exists(target, error) && !fs::is_regular_file(target, error))
        throw InputError("--output {}: is there and not a regular file", path);
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
    write_aside(path, spec, OIIO::TypeDesc::FLOAT, pixels.data());
}

void write_png(const std::string& path, const Image& image, float scale, const Metadata& metadata) {
    OIIO::ImageSpec spec(static_cast<int>(image.width), static_cast<int>(image.height), 3,
                         OIIO::TypeDesc::UINT8);
    spec.attribute("oiio:ColorSpace", "sRGB");
    set_metadata(spec, metadata);
    std::vector<unsigned char> pixels(image.pixel_count() * 3);
    for (std::size_t i = 0; i < image.pixel_count(); ++i)
        for (std::size_t c = 0; c < 3; ++c) {
            const float linear =
                std::clamp(image.values[i * image.channels.size() + c] * scale, 0.0f, 1.0f);
            const float encoded = linear <= 0.0031308f
                                      ? 12.92f * linear
                                      : 1.055f * std::pow(linear, 1 / 2.4f) - 0.055f;
            pixels[3 * i + c] = static_cast<unsigned char>(std::lround(255 * encoded));
        }
    write_aside(path, spec, OIIO::TypeDesc::UINT8, pixels.data());
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

Image read_rgb(const std::string& path) {
    const std::unique_ptr<OIIO::ImageInput> in = OIIO::ImageInput::open(path);
    if (!in) throw InputError("{}: cannot be read: {}", path, OIIO::geterror());
    const OIIO::ImageSpec& spec = in->spec();
    std::vector<float> pixels(std::size_t{static_cast<unsigned>(spec.width)} * spec.height *
                              spec.nchannels);
    if (!in->read_image(0, 0, 0, -1, OIIO::TypeDesc::FLOAT, pixels.data()))
        throw InputError("{}: cannot be read: {}", path, in->geterror());
    Image image(spec.width, spec.height, {"R", "G", "B"});
    for (int c = 0; c < 3; ++c) {
        const int channel = spec.channelindex(image.channels[c]);
        if (channel < 0) throw InputError("{}: has no channel {}", path, image.channels[c]);
        for (std::size_t i = 0; i < image.pixel_count(); ++i)
            image.values[3 * i + c] = pixels[i * spec.nchannels + channel];
    }
    return image;
}

}  // namespace manylight

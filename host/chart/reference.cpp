// SPDX-License-Identifier: MIT
#include "chart/reference.hpp"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "device/kernel_sources.hpp"
#include "error.hpp"
#include "output/hash.hpp"
#include "output/metrics.hpp"

namespace manylight {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr std::size_t most_lights = 20'000;                    // of which all are drawn
constexpr std::size_t drawn_per_image = std::size_t{1} << 27;  // light samples, about
constexpr std::size_t fewest_drawn = 64, most_drawn = 1024;    // of a pixel
constexpr uint light_samples = 16;                             // of sampler adaptive
constexpr const char* fact = "manylight:reference";
const std::vector<std::string> layers = {"R",           "G",           "B",
                                         "deviation.R", "deviation.G", "deviation.B"};

}  // namespace

Reference::Reference(unsigned width, unsigned height, bool exact)
    : width_(width),
      height_(height),
      exact_(exact),
      means_(std::size_t{3} * width * height),
      deviations_(means_.size()) {}

// Welford's update.
void Reference::add(const Image& image, double seconds) {
    seconds_ += seconds;
    luminances_.push_back(mean_luminance(image));
    const auto count = static_cast<double>(luminances_.size());
    for (std::size_t i = 0; i < means_.size(); ++i) {
        const double before = image.values[i] - means_[i];
        means_[i] += before / count;
        deviations_[i] += before * (image.values[i] - means_[i]);
    }
}

Image Reference::image() const {
    Image out(width_, height_, {"R", "G", "B"});
    std::ranges::transform(means_, out.values.begin(),
                           [](double v) { return static_cast<float>(v); });
    return out;
}

ErrorEstimate Reference::error() const {
    ErrorEstimate out{0, 0, Image(width_, height_, {"error.R", "error.G", "error.B"})};
    if (exact_) return out;
    const double scale = 0.5 / luminance().value;
    const auto count = static_cast<double>(luminances_.size());
    double squares = 0;
    for (std::size_t i = 0; i < means_.size(); ++i) {
        const double x = scale * means_[i];
        const double variance = scale * scale * deviations_[i] / (count * (count - 1));
        const double error = variance / (x * x + 0.01);
        out.pixels.values[i] = static_cast<float>(error);
        out.relmse += error;
        squares += error * error;
    }
    out.relmse /= static_cast<double>(means_.size());
    out.standard_error = std::sqrt(squares) / static_cast<double>(means_.size());
    return out;
}

Mean Reference::luminance() const {
    Mean out = mean_of(luminances_);
    if (exact_) out.standard_error = 0;
    return out;
}

void Reference::save(const std::string& path, const std::string& key) const {
    Image out(width_, height_, layers);
    for (std::size_t i = 0; i < out.pixel_count(); ++i)
        for (std::size_t c = 0; c < 3; ++c) {
            out.values[6 * i + c] = static_cast<float>(means_[3 * i + c]);
            out.values[6 * i + 3 + c] = static_cast<float>(deviations_[3 * i + c]);
        }
    const json facts = {{"key", key}, {"luminances", luminances_}, {"seconds", seconds_}};
    write_exr(path, {out}, {{fact, facts.dump(-1, ' ', true, json::error_handler_t::replace)}});
}

Reference Reference::load(const std::string& path, const std::string& key, unsigned width,
                          unsigned height, bool exact) {
    std::map<std::string, std::string> texts = {{fact, ""}};
    const Image in = read_channels(path, layers, texts);
    const json facts = json::parse(texts[fact], nullptr, false);
    const bool known =
        facts.is_object() && facts.value("key", json()) == json(key) &&
        facts.contains("luminances") && facts["luminances"].is_array() &&
        std::ranges::all_of(facts["luminances"], [](const json& l) { return l.is_number(); });
    if (!known || in.width != width || in.height != height || facts["luminances"].empty())
        throw InputError("{}: is no reference of this scene and these options", path);
    Reference out(width, height, exact);
    out.luminances_ = facts["luminances"].get<std::vector<double>>();
    out.seconds_ = facts["seconds"].get<double>();
    for (std::size_t i = 0; i < in.pixel_count(); ++i)
        for (std::size_t c = 0; c < 3; ++c) {
            out.means_[3 * i + c] = in.values[6 * i + c];
            out.deviations_[3 * i + c] = in.values[6 * i + 3 + c];
        }
    return out;
}

Setting reference_setting(const Renderer& renderer) {
    const std::size_t pixels = std::size_t{renderer.width()} * renderer.height();
    const auto drawn = static_cast<uint>(
        std::clamp<std::size_t>(drawn_per_image / pixels, fewest_drawn, most_drawn));
    const std::size_t lights = renderer.scene().lights.size();
    if (lights > most_lights || renderer.is_whole())
        return {"adaptive", light_samples, drawn / light_samples};
    const bool exact = renderer.is_exact(find_sampler("exhaustive"));
    const auto count = static_cast<uint>(std::max<std::size_t>(lights, 1));
    return {"exhaustive", count, exact ? 1 : std::max(1u, drawn / count)};
}

std::string reference_name(const Renderer& renderer, const Setting& setting) {
    ContentHash hash;
    hash.add(renderer.scene());
    hash.add(std::as_bytes(std::span(&renderer.camera(), 1)));
    hash.add(renderer.width()).add(renderer.height()).add(renderer.is_whole());
    hash.add(setting.sampler).add(setting.light_samples).add(setting.spp);
    for (const auto& [file, text] : kernel_sources) hash.add(text);
    return hash.add(MANYLIGHT_VERSION).name() + ".exr";
}

std::string reference_folder(const std::string& asked) {
    fs::path folder = asked;
    if (asked.empty()) {
        const char* cache = std::getenv("XDG_CACHE_HOME");
        const char* home = std::getenv("HOME");
        if (cache != nullptr && *cache == '/')
            folder = cache;
        else if (home != nullptr && *home != '\0')
            folder = fs::path(home) / ".cache";
        else
            throw InputError("neither XDG_CACHE_HOME nor HOME is set: name a folder with --cache");
        folder = folder / "manylight" / "references";
    }
    std::error_code error;
    fs::create_directories(folder, error);
    if (!fs::is_directory(folder, error))
        throw InputError("--cache {}: cannot be made a folder", folder.string());
    if (access(folder.c_str(), W_OK) != 0)
        throw InputError("--cache {}: the folder cannot be written", folder.string());
    return folder.string();
}

}  // namespace manylight

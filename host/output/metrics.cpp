// SPDX-License-Identifier: MIT
#include "output/metrics.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "error.hpp"

namespace manylight {
namespace {

// The scale that brings the mean luminance of a reference to 0.5.
double scale_of(const Image& reference, const std::string& name) {
    const auto bad =
        std::ranges::find_if(reference.values, [](float v) { return !std::isfinite(v); });
    if (bad != reference.values.end())
        throw InputError("{}: {} is {}, so it is no reference", name,
                         place_of_value(reference, bad - reference.values.begin()), *bad);
    const double luminance = mean_luminance(reference);
    if (!(luminance > 0))
        throw InputError("{}: its mean luminance is {}, so it is no reference", name, luminance);
    return 0.5 / luminance;
}

// The part of a sum that its largest `share` of terms make.
double share_of_largest(std::vector<float> terms, double share) {
    const double all = std::accumulate(terms.begin(), terms.end(), 0.0);
    if (!(all > 0)) return 0;
    const auto count =
        static_cast<std::ptrdiff_t>(std::ceil(share * static_cast<double>(terms.size())));
    std::nth_element(terms.begin(), terms.begin() + count - 1, terms.end(), std::greater<>());
    return std::accumulate(terms.begin(), terms.begin() + count, 0.0) / all;
}

}  // namespace

double mean_luminance(const Image& image) {
    double sum = 0;
    for (std::size_t i = 0; i < image.pixel_count(); ++i) {
        const float* p = image.values.data() + 3 * i;
        sum += 0.2126 * p[0] + 0.7152 * p[1] + 0.0722 * p[2];
    }
    return sum / static_cast<double>(image.pixel_count());
}

std::string place_of_value(const Image& image, std::size_t value) {
    const std::size_t channels = image.channels.size();
    const std::size_t pixel = value / channels;
    return fmt::format("pixel {}, {}, channel {}", pixel % image.width, pixel / image.width,
                       image.channels[value % channels]);
}

Difference compare_images(const Image& image, const Image& reference, const std::string& a,
                          const std::string& b) {
    if (image.width != reference.width || image.height != reference.height)
        throw InputError("{} is {} x {} pixels, but {} is {} x {}", a, image.width, image.height, b,
                         reference.width, reference.height);
    const double scale = scale_of(reference, b);
    constexpr double weights[] = {0.2126, 0.7152, 0.0722};
    Difference out;
    out.pixels.resize(image.pixel_count());
    double luminance = 0;
    double reference_luminance = 0;
    for (std::size_t i = 0; i < image.values.size(); ++i) {
        if (!std::isfinite(image.values[i])) {
            if (out.bad++ == 0) out.first_bad = i;
            continue;
        }
        const double x = scale * image.values[i];
        const double r = scale * reference.values[i];
        const double error = (x - r) * (x - r) / (r * r + 0.01);
        out.pixels[i / 3] += static_cast<float>(error / 3);
        out.relmse += error;
        out.mape += std::abs(x - r) / (std::abs(r) + 0.01);
        out.rmse += (x - r) * (x - r);
        luminance += weights[i % 3] * x;
        reference_luminance += weights[i % 3] * r;
    }
    const auto count = static_cast<double>(image.values.size() - out.bad);
    out.relmse /= count;
    out.mape /= count;
    out.rmse = std::sqrt(out.rmse / count) / scale;
    out.bias = luminance / reference_luminance - 1;
    out.worst_hundredth = share_of_largest(out.pixels, 0.01);
    out.worst_thousandth = share_of_largest(out.pixels, 0.001);
    return out;
}

}  // namespace manylight

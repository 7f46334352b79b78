// SPDX-License-Identifier: MIT
#include "output/metrics.hpp"

#include <cmath>

#include "error.hpp"

namespace manylight {

Difference compare_images(const Image& image, const Image& reference, const std::string& a,
                          const std::string& b) {
    if (image.width != reference.width || image.height != reference.height)
        throw InputError("{} is {} x {} pixels, but {} is {} x {}", a, image.width, image.height, b,
                         reference.width, reference.height);
    double luminance = 0;
    for (std::size_t i = 0; i < reference.pixel_count(); ++i) {
        const float* r = reference.values.data() + 3 * i;
        luminance += 0.2126 * r[0] + 0.7152 * r[1] + 0.0722 * r[2];
    }
    luminance /= static_cast<double>(reference.pixel_count());
    if (!(std::isfinite(luminance) && luminance > 0))
        throw InputError("{}: its mean luminance is {}, so it is no reference", b, luminance);
    const double scale = 0.5 / luminance;
    Difference out;
    double sum = 0;
    double reference_sum = 0;
    std::size_t count = 0;
    for (std::size_t i = 0; i < image.values.size(); ++i) {
        if (!std::isfinite(image.values[i])) {
            ++out.bad;
            continue;
        }
        const double x = image.values[i];
        const double r = reference.values[i];
        out.relmse += scale * scale * (x - r) * (x - r) / (scale * scale * r * r + 0.01);
        out.rmse += (x - r) * (x - r);
        sum += x;
        reference_sum += r;
        ++count;
    }
    out.relmse /= static_cast<double>(count);
    out.rmse = std::sqrt(out.rmse / static_cast<double>(count));
    out.bias = sum / reference_sum - 1;
    return out;
}

}  // namespace manylight

// SPDX-License-Identifier: MIT
#include "output/error_estimate.hpp"

#include <cmath>

namespace manylight {

ErrorEstimate estimate_error(const Image& image, const std::vector<float4>& differences,
                             const std::vector<float>& weights) {
    ErrorEstimate out{0, 0, Image(image.width, image.height, {"error.R", "error.G", "error.B"})};
    double luminance = 0;
    for (std::size_t i = 0; i < image.pixel_count(); ++i) {
        const float* p = image.values.data() + 3 * i;
        luminance += 0.2126 * p[0] + 0.7152 * p[1] + 0.0722 * p[2];
    }
    if (!(luminance > 0)) return out;
    const double scale = 0.5 * static_cast<double>(image.pixel_count()) / luminance;
    double sum = 0;
    double squares = 0;
    for (unsigned y = 0; y < image.height; ++y)
        for (unsigned column = 0; column < image.width; ++column) {
            const std::size_t i = std::size_t{y} * image.width + column;
            const float4& d = differences[i];
            if (d.w == 0) continue;
            double pixel = 0;
            for (int c = 0; c < 3; ++c) {
                const double square = d[c] * d[c] / (double{d.w} * weights[i]);
                const double x = scale * image.at(column, y)[c];
                const double error = scale * scale * square / (x * x + 0.01);
                out.pixels.at(column, y)[c] = static_cast<float>(error);
                pixel += error / 3;
            }
            sum += pixel;
            squares += pixel * pixel;
        }
    out.relmse = sum / static_cast<double>(image.pixel_count());
    out.standard_error = std::sqrt(squares) / static_cast<double>(image.pixel_count());
    return out;
}

}  // namespace manylight

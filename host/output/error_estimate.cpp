// SPDX-License-Identifier: MIT
#include "output/error_estimate.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace manylight {
namespace {

// Sets of groups, a bit for each.
using Parts = std::vector<unsigned>;
static_assert(ERROR_GROUPS == 4);
const Parts halves = {0b0101, 0b1010};  // each stratified by itself
const Parts quarters = {0b0001, 0b0010, 0b0100, 0b1000};

Parts without(unsigned group) {
    Parts out = quarters;
    out.erase(out.begin() + group);
    return out;
}

// The mean of a pixel's channel over parts of its samples, and the variance that this would have
// with the weight of all samples. `parts`: those that have any; of less than two there is no
// variance. `share`: of all weight.
struct Moments {
    double mean = 0;
    double variance = 0;
    unsigned parts = 0;
    double share = 0;
};

Moments moments_of(const float4* groups, int channel, const Parts& parts) {
    Moments out;
    double sums[ERROR_GROUPS] = {};
    double weights[ERROR_GROUPS] = {};
    double weight = 0;
    double all = 0;
    for (unsigned g = 0; g < ERROR_GROUPS; ++g) {
        all += groups[g].w;
        for (std::size_t p = 0; p < parts.size(); ++p) {
            if ((parts[p] >> g & 1) == 0) continue;
            sums[p] += groups[g][channel];
            weights[p] += groups[g].w;
            out.mean += groups[g][channel];
            weight += groups[g].w;
        }
    }
    for (const double w : weights) out.parts += w > 0;
    if (out.parts < 2) return out;
    out.mean /= weight;
    out.share = weight / all;
    for (std::size_t p = 0; p < parts.size(); ++p)
        if (weights[p] > 0)
            out.variance += weights[p] * std::pow(sums[p] / weights[p] - out.mean, 2);
    out.variance /= (out.parts - 1) * all;
    return out;
}

// Of a neighbourhood of 3 x 3 pixels.
struct Sums {
    double count = 0, mean = 0, square = 0, variance = 0;
    Sums& operator+=(const Sums& other) {
        count += other.count;
        mean += other.mean;
        square += other.square;
        variance += other.variance;
        return *this;
    }
};

// What a pixel would be without noise: its neighbourhood's mean, and of its own difference from
// that as much as is not noise there (Lee, "Digital Image Enhancement and Noise Filtering by Use of
// Local Statistics", 1980). At least half as bright as it is: beside a small and bright spot, what
// one sample in a hundred sees is not as dark as the neighbours.
double without_noise(double x, const Sums& near) {
    const double mean = near.mean / near.count;
    double kept = 1;
    if (near.count > 1) {
        const double spread = (near.square - near.mean * mean) / (near.count - 1);
        const double noise = near.variance / near.count;
        kept = spread > noise ? (spread - noise) / spread : 0;
    }
    return std::max(mean + kept * (x - mean), x / 2);
}

class Estimator {
  public:
    Estimator(unsigned width, unsigned height, const std::vector<float4>& groups,
              const std::vector<double>& weights, double scale)
        : width_(width),
          height_(height),
          groups_(groups),
          weights_(weights),
          scale_(scale),
          moments_(weights.size()) {}

    // A channel's part of relMSE in each pixel that has samples of two of the parts.
    template <class Add>
    void visit(int channel, const Parts& parts, const Add& add) {
        for (std::size_t i = 0; i < moments_.size(); ++i) {
            moments_[i] = {};
            if (weights_[i] == 0) continue;
            moments_[i] = moments_of(&groups_[ERROR_GROUPS * i], channel, parts);
            moments_[i].mean *= scale_;
            moments_[i].variance *= scale_ * scale_;
        }
        std::vector<Sums> columns(width_);
        for (unsigned y = 0; y < height_; ++y) {
            for (unsigned x = 0; x < width_; ++x) columns[x] = column(x, y);
            for (unsigned x = 0; x < width_; ++x) {
                const std::size_t i = std::size_t{y} * width_ + x;
                const Moments& own = moments_[i];
                if (own.parts < 2) continue;
                Sums near = columns[x];
                if (x > 0) near += columns[x - 1];
                if (x + 1 < width_) near += columns[x + 1];
                const double level = without_noise(own.mean, near);
                add(i, own.variance / (level * level + 0.01), own);
            }
        }
    }

    // The jackknife of quarters, over their plain estimate: 1 where no pixel has three of them.
    double correction() {
        double plain = 0;
        double corrected = 0;
        std::vector<unsigned char> parts(weights_.size());
        std::vector<double> pixels(weights_.size());
        for (int c = 0; c < 3; ++c) {
            std::ranges::fill(parts, 0);
            visit(c, quarters, [&](std::size_t i, double error, const Moments& own) {
                if (own.parts < 3) return;
                parts[i] = static_cast<unsigned char>(own.parts);
                pixels[i] = own.parts * error;
                plain += error;
            });
            for (unsigned g = 0; g < ERROR_GROUPS; ++g)
                visit(c, without(g), [&](std::size_t i, double error, const Moments& own) {
                    if (own.parts < parts[i]) pixels[i] -= own.share * error;
                });
            for (std::size_t i = 0; i < pixels.size(); ++i)
                if (parts[i] > 0) corrected += std::max(pixels[i], 0.0);
        }
        return plain > 0 ? corrected / plain : 1;
    }

  private:
    [[nodiscard]] Sums column(unsigned x, unsigned y) const {
        Sums out;
        for (unsigned v = y > 0 ? y - 1 : 0; v < std::min(y + 2, height_); ++v) {
            const Moments& m = moments_[std::size_t{v} * width_ + x];
            if (m.parts >= 2) out += {1, m.mean, m.mean * m.mean, m.variance};
        }
        return out;
    }

    unsigned width_, height_;
    const std::vector<float4>& groups_;
    const std::vector<double>& weights_;
    double scale_;
    std::vector<Moments> moments_;
};

// The weight of all samples of a pixel; 0 where it is not finite.
double weight_of(const float4* sums, double& luminance) {
    double weight = 0;
    glm::dvec3 sum(0);
    for (unsigned g = 0; g < ERROR_GROUPS; ++g) {
        sum += glm::dvec3(glm::vec3(sums[g]));
        weight += sums[g].w;
    }
    luminance = weight > 0 ? (0.2126 * sum.x + 0.7152 * sum.y + 0.0722 * sum.z) / weight : 0;
    return std::isfinite(luminance) ? weight : 0;
}

}  // namespace

std::optional<ErrorEstimate> estimate_error(unsigned width, unsigned height,
                                            const std::vector<float4>& groups) {
    const std::size_t pixels = std::size_t{width} * height;
    std::vector<double> weights(pixels);
    double luminance = 0;
    std::size_t count = 0;
    for (std::size_t i = 0; i < pixels; ++i) {
        double own = 0;
        weights[i] = weight_of(&groups[ERROR_GROUPS * i], own);
        if (weights[i] == 0) continue;
        luminance += own;
        ++count;
    }
    if (!(luminance > 0)) return {};
    const double scale = 0.5 * static_cast<double>(count) / luminance;

    ErrorEstimate out{0, 0, Image(width, height, {"error.R", "error.G", "error.B"})};
    std::ranges::fill(out.pixels.values, std::numeric_limits<float>::quiet_NaN());
    Estimator estimator(width, height, groups, weights, scale);
    const double correction = estimator.correction();
    for (int c = 0; c < 3; ++c)
        estimator.visit(c, halves, [&](std::size_t i, double error, const Moments&) {
            out.pixels.values[3 * i + c] = static_cast<float>(correction * error);
        });

    double sum = 0;
    double squares = 0;
    double by_weight = 0;
    std::size_t estimated = 0;
    std::vector<std::size_t> others;
    for (std::size_t i = 0; i < pixels; ++i) {
        if (weights[i] == 0) continue;
        const float* p = &out.pixels.values[3 * i];
        if (std::isnan(p[0])) {
            others.push_back(i);
            continue;
        }
        const double pixel = (double{p[0]} + p[1] + p[2]) / 3;
        sum += pixel;
        squares += pixel * pixel;
        by_weight += pixel * weights[i];
        ++estimated;
    }
    if (estimated == 0) return {};
    double rest = 0;
    for (const std::size_t i : others) {
        const double pixel = by_weight / static_cast<double>(estimated) / weights[i];
        std::fill_n(&out.pixels.values[3 * i], 3, static_cast<float>(pixel));
        rest += pixel;
    }
    out.relmse = (sum + rest) / static_cast<double>(count);
    // Half the difference of two halves is distributed as the error of their mean is: what is
    // between the estimate and the error varies twice as much as one of them, and one varies by the
    // pixels' squares at most. How true the correction is, is not known: all of it counts.
    if (sum > 0)
        out.standard_error =
            out.relmse * std::hypot(std::sqrt(2 * squares) / sum, 1 - 1 / correction);
    return out;
}

}  // namespace manylight

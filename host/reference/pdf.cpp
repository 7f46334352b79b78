// SPDX-License-Identifier: MIT
#include "reference/pdf.hpp"

#include <cmath>

namespace manylight::reference {

std::vector<double> probabilities(std::span<const float> row, const RowSum& total,
                                  std::span<const Light> lights, const Mixture& mixture) {
    std::vector<double> p(row.size(), 0.0);
    double shares = 0;
    const auto mix = [&](double share, double sum, auto&& weight) {
        if (!(sum > 0)) return;
        shares += share;
        for (std::size_t y = 0; y < row.size(); ++y) p[y] += share * weight(y) / sum;
    };
    mix(mixture.visible, total.visible, [&](std::size_t y) { return row[y] > 0 ? row[y] : 0.f; });
    mix(mixture.unshadowed, total.unshadowed, [&](std::size_t y) { return std::abs(row[y]); });
    mix(mixture.power, mixture.total_power, [&](std::size_t y) { return lights[y].emission.w; });
    if (shares > 0)
        for (double& probability : p) probability /= shares;
    return p;
}

}  // namespace manylight::reference

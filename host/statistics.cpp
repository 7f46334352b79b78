// SPDX-License-Identifier: MIT
#include "statistics.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace manylight {

Quartiles quartiles(std::vector<double> values) {
    std::ranges::sort(values);
    const auto at = [&](double share) {
        const double place = share * static_cast<double>(values.size() - 1);
        const auto i = static_cast<std::size_t>(place);
        const double next = values[std::min(i + 1, values.size() - 1)];
        return values[i] + (place - static_cast<double>(i)) * (next - values[i]);
    };
    return {at(0.25), at(0.5), at(0.75)};
}

Mean mean_of(const std::vector<double>& values) {
    const auto count = static_cast<double>(values.size());
    Mean out{std::accumulate(values.begin(), values.end(), 0.0) / count, {}};
    if (values.size() < 2) return out;
    double squares = 0;
    for (const double v : values) squares += (v - out.value) * (v - out.value);
    out.standard_error = std::sqrt(squares / (count - 1) / count);
    return out;
}

Ratio ratio_of(const std::vector<double>& ratios) {
    std::vector<double> logs;
    for (const double r : ratios) logs.push_back(std::log(r));
    const Mean mean = mean_of(logs);
    Ratio out{std::exp(mean.value), {}, {}};
    if (!mean.standard_error) return out;
    const double reach = student_quantile(logs.size() - 1) * *mean.standard_error;
    out.lower = std::exp(mean.value - reach);
    out.upper = std::exp(mean.value + reach);
    return out;
}

double student_quantile(std::size_t degrees) {
    constexpr double exact[] = {12.706, 4.303, 3.182, 2.776};
    if (degrees <= std::size(exact)) return exact[degrees - 1];
    // Cornish and Fisher's expansion, to 0.2% from 5 degrees on.
    const double z = 1.959964;
    const auto k = static_cast<double>(degrees);
    return z + (z * z * z + z) / (4 * k) +
           (5 * std::pow(z, 5) + 16 * z * z * z + 3 * z) / (96 * k * k) +
           (3 * std::pow(z, 7) + 19 * std::pow(z, 5) + 17 * z * z * z - 15 * z) / (384 * k * k * k);
}

}  // namespace manylight

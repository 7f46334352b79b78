// SPDX-License-Identifier: MIT
#include "statistics.hpp"

#include <algorithm>
#include <boost/math/distributions/students_t.hpp>
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
    const boost::math::students_t student(static_cast<double>(degrees));
    return quantile(complement(student, 0.025));
}

}  // namespace manylight

// SPDX-License-Identifier: MIT
// What is said of repeated measurements.
#pragma once

#include <optional>
#include <vector>

namespace manylight {

/// A median with its quartiles.
struct Quartiles {
    double lower = 0, median = 0, upper = 0;
};
[[nodiscard]] Quartiles quartiles(std::vector<double> values);

/// A mean with its standard error.
struct Mean {
    double value = 0;
    std::optional<double> standard_error;  // none of a single value
};
[[nodiscard]] Mean mean_of(const std::vector<double>& values);

/// A ratio with the ends of its confidence interval of 95%.
struct Ratio {
    double value = 0;
    std::optional<double> lower, upper;  // none of a single ratio
};

/// The geometric mean of ratios above 0, each of one repeat, and Student's interval of their
/// logarithms' mean.
[[nodiscard]] Ratio ratio_of(const std::vector<double>& ratios);

/// What Student's t with so many degrees of freedom, at least 1, exceeds with a chance of 2.5%.
[[nodiscard]] double student_quantile(std::size_t degrees);

}  // namespace manylight

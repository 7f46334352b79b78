// SPDX-License-Identifier: MIT
// What the runs of a chart say together.
#pragma once

#include "chart/measure.hpp"

namespace manylight {

/// All runs of one setting.
struct SettingSummary {
    Setting setting;
    std::vector<const Run*> runs;  // in the order of their seeds
    Quartiles seconds, relmse, mape;
    Quartiles worst_hundredth, worst_thousandth;     // see Difference
    double prepare_seconds = 0, render_seconds = 0;  // medians, as are the following
    std::map<std::string, double> stage_seconds;
    double bias = 0;                   // mean of luminance over the reference's, minus 1
    std::optional<double> bias_error;  // its standard error, the reference's included
    std::optional<double> z;           // bias over that; none where all images are alike
    bool limited = false;  // the reference's error is not much smaller (see reference_ratio)
};

/// One for each setting that was measured, in their order.
[[nodiscard]] std::vector<SettingSummary> summarise(const Chart& chart);

/// A value of a run that is the smaller, the better.
using Metric = double (*)(const Run&);

/// The error of a setting over the baseline's of the same seed, over all seeds of both; none where
/// an error is 0.
[[nodiscard]] std::optional<Ratio> equal_samples(const SettingSummary& of,
                                                 const SettingSummary& baseline, Metric metric);

/// The error that a sampler has in the time that the baseline took with the same seed, over the
/// baseline's. It is read (log-log) between the sampler's own runs of that seed; none where its
/// ladder does not reach that time.
[[nodiscard]] std::optional<Ratio> equal_time(const std::vector<const SettingSummary*>& ladder,
                                              const SettingSummary& baseline, Metric metric);

/// The error at a time between points (seconds, error) above 0, of which those count that no
/// faster one is better than.
[[nodiscard]] std::optional<double> error_at(std::vector<std::pair<double, double>> points,
                                             double seconds);

}  // namespace manylight

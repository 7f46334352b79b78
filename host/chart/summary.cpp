// SPDX-License-Identifier: MIT
#include "chart/summary.hpp"

#include <algorithm>
#include <cmath>

namespace manylight {
namespace {

// Below this share of the luminance, differences are rounding.
constexpr double rounding = 1e-7;

template <class Value>
Quartiles quartiles_of(const std::vector<const Run*>& runs, Value value) {
    std::vector<double> values;
    for (const Run* run : runs) values.push_back(value(*run));
    return quartiles(std::move(values));
}

void set_bias(SettingSummary& out, const Mean& reference) {
    std::vector<double> biases;
    for (const Run* run : out.runs) biases.push_back(run->luminance / reference.value - 1);
    const Mean mean = mean_of(biases);
    out.bias = mean.value;
    if (!mean.standard_error || !reference.standard_error) return;
    out.bias_error = std::hypot(*mean.standard_error, *reference.standard_error / reference.value);
    if (*out.bias_error > rounding) out.z = out.bias / *out.bias_error;
}

void set_stages(SettingSummary& out) {
    for (const Run* first : out.runs)
        for (const auto& [stage, seconds] : first->rendering.stage_seconds)
            out.stage_seconds[stage] =
                quartiles_of(out.runs, [&stage = stage](const Run& run) {
                    const auto found = run.rendering.stage_seconds.find(stage);
                    return found == run.rendering.stage_seconds.end() ? 0.0 : found->second;
                }).median;
}

const Run* run_of(const SettingSummary& summary, uint seed) {
    const auto found = std::ranges::find(summary.runs, seed, &Run::seed);
    return found == summary.runs.end() ? nullptr : *found;
}

}  // namespace

std::vector<SettingSummary> summarise(const Chart& chart) {
    const double own_error = chart.reference.error().relmse;
    const Mean luminance = chart.reference.luminance();
    std::vector<SettingSummary> out;
    for (const Setting& setting : chart.settings) {
        SettingSummary s;
        s.setting = setting;
        for (const Run& run : chart.runs)
            if (run.setting == setting) s.runs.push_back(&run);
        s.seconds = quartiles_of(s.runs, [](const Run& r) { return r.rendering.seconds(); });
        s.relmse = quartiles_of(s.runs, [](const Run& r) { return r.difference.relmse; });
        s.mape = quartiles_of(s.runs, [](const Run& r) { return r.difference.mape; });
        s.worst_hundredth =
            quartiles_of(s.runs, [](const Run& r) { return r.difference.worst_hundredth; });
        s.worst_thousandth =
            quartiles_of(s.runs, [](const Run& r) { return r.difference.worst_thousandth; });
        s.prepare_seconds =
            quartiles_of(s.runs, [](const Run& r) { return r.rendering.prepare_seconds; }).median;
        s.render_seconds =
            quartiles_of(s.runs, [](const Run& r) { return r.rendering.render_seconds; }).median;
        s.limited = own_error * reference_ratio > s.relmse.median;
        set_stages(s);
        set_bias(s, luminance);
        out.push_back(std::move(s));
    }
    return out;
}

std::optional<Ratio> equal_samples(const SettingSummary& of, const SettingSummary& baseline,
                                   Metric metric) {
    std::vector<double> ratios;
    for (const Run* run : baseline.runs) {
        const Run* other = run_of(of, run->seed);
        if (other == nullptr) continue;
        if (!(metric(*other) > 0) || !(metric(*run) > 0)) return {};
        ratios.push_back(metric(*other) / metric(*run));
    }
    if (ratios.empty()) return {};
    return ratio_of(ratios);
}

std::optional<Ratio> equal_time(const std::vector<const SettingSummary*>& ladder,
                                const SettingSummary& baseline, Metric metric) {
    std::vector<double> ratios;
    for (const Run* run : baseline.runs) {
        std::vector<std::pair<double, double>> points;
        for (const SettingSummary* step : ladder)
            if (const Run* other = run_of(*step, run->seed))
                points.emplace_back(other->rendering.seconds(), metric(*other));
        if (points.size() < 2) continue;  // seeds that a slow sampler has not
        const bool positive = std::ranges::all_of(points, [](auto& p) { return p.second > 0; });
        if (!positive || !(metric(*run) > 0)) return {};
        const std::optional<double> error = error_at(std::move(points), run->rendering.seconds());
        if (!error) return {};
        ratios.push_back(*error / metric(*run));
    }
    if (ratios.empty()) return {};
    return ratio_of(ratios);
}

std::optional<double> error_at(std::vector<std::pair<double, double>> points, double seconds) {
    std::ranges::sort(points);
    const double last = points.back().first;
    std::vector<std::pair<double, double>> best;
    for (const auto& point : points)
        if (best.empty() || point.second < best.back().second) best.push_back(point);
    if (seconds < best.front().first || seconds > last) return {};
    const auto after = std::ranges::find_if(best, [&](auto& p) { return p.first > seconds; });
    if (after == best.end()) return best.back().second;
    const auto& [t0, e0] = *(after - 1);
    const auto& [t1, e1] = *after;
    return e0 * std::exp(std::log(e1 / e0) / std::log(t1 / t0) * std::log(seconds / t0));
}

}  // namespace manylight

// SPDX-License-Identifier: MIT
#include "chart/chart_json.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>

#include "output/error_picture.hpp"

namespace manylight {
namespace {

using nlohmann::json;

template <class T>
json or_null(const std::optional<T>& value) {
    return value ? json(*value) : json();
}

json to_json(const Setting& s) {
    return {{"sampler", s.sampler}, {"light_samples", s.light_samples}, {"spp", s.spp}};
}

json to_json(const Quartiles& q) {
    return {{"median", q.median}, {"lower", q.lower}, {"upper", q.upper}};
}

json ratio_json(const std::optional<Ratio>& ratio) {
    if (!ratio) return {};
    return {{"ratio", ratio->value},
            {"lower", or_null(ratio->lower)},
            {"upper", or_null(ratio->upper)}};
}

json to_json(const Run& run) {
    json out = to_json(run.setting);
    const Rendering& r = run.rendering;
    const Difference& d = run.difference;
    out["seed"] = run.seed;
    out["seconds"] = {{"start", r.start_seconds},
                      {"prepare", r.prepare_seconds},
                      {"render", r.render_seconds},
                      {"compile", r.compile_seconds}};
    out["stage_seconds"] = r.stage_seconds;
    out["rays"] = {{"primary", r.primary_rays}, {"shadow", r.shadow_rays}};
    out["relmse"] = d.relmse;
    out["mape"] = d.mape;
    out["rmse"] = d.rmse;
    out["bias"] = d.bias;
    out["worst_1_percent"] = d.worst_hundredth;
    out["worst_0.1_percent"] = d.worst_thousandth;
    return out;
}

json to_json(const SettingSummary& s) {
    json out = to_json(s.setting);
    out["runs"] = s.runs.size();
    out["seconds"] = to_json(s.seconds);
    out["prepare_seconds"] = s.prepare_seconds;
    out["render_seconds"] = s.render_seconds;
    out["stage_seconds"] = s.stage_seconds;
    out["relmse"] = to_json(s.relmse);
    out["mape"] = to_json(s.mape);
    out["worst_1_percent"] = to_json(s.worst_hundredth);
    out["worst_0.1_percent"] = to_json(s.worst_thousandth);
    out["bias"] = s.bias;
    out["bias_standard_error"] = or_null(s.bias_error);
    out["z"] = or_null(s.z);
    out["z_limit"] = s.runs.size() > 1 ? json(student_quantile(s.runs.size() - 1)) : json();
    out["limited_by_reference"] = s.limited;
    return out;
}

json samplers_json(const Chart& chart) {
    json out = json::array();
    for (const std::string& name : chart.options.samplers) {
        const Sampler& sampler = find_sampler(name);
        const auto compiled = chart.compile_seconds.find(name);
        out.push_back(
            {{"name", name},
             {"summary", sampler.summary},
             {"color", sampler.color},
             {"biased", sampler.biased},
             {"all_lights", sampler.all_lights},
             {"compile_seconds", compiled == chart.compile_seconds.end() ? 0 : compiled->second}});
    }
    return out;
}

json left_out_json(const Chart& chart) {
    json out = json::array();
    for (const LeftOut& left : chart.left_out) {
        out.push_back(to_json(left.setting));
        out.back()["reason"] = left.reason;
    }
    return out;
}

json reference_json(const Chart& chart) {
    const Reference& r = chart.reference;
    const ErrorEstimate error = r.error();
    const Mean luminance = r.luminance();
    const Sampler& sampler = find_sampler(chart.reference_setting.sampler);
    return {{"sampler", sampler.name},
            {"light_samples", chart.reference_setting.light_samples},
            {"spp", chart.reference_setting.spp * r.count()},
            {"images", r.count()},
            {"images_from_cache", chart.cached_images},
            {"seconds", r.seconds()},
            {"relmse", error.relmse},
            {"relmse_standard_error", error.standard_error},
            {"luminance", luminance.value},
            {"luminance_standard_error", or_null(luminance.standard_error)},
            {"judges_relmse", chart.smallest_error},
            {"file", "reference.exr"}};
}

// Of every sampler over the baseline, at every setting of the baseline.
json ratios_json(const Chart& chart, const std::vector<SettingSummary>& summaries) {
    json out = json::array();
    const std::pair<const char*, Metric> metrics[] = {
        {"relmse", [](const Run& r) { return r.difference.relmse; }},
        {"mape", [](const Run& r) { return r.difference.mape; }}};
    for (const SettingSummary& base : summaries) {
        if (base.setting.sampler != chart.options.baseline) continue;
        for (const std::string& name : chart.options.samplers) {
            if (name == base.setting.sampler) continue;
            std::vector<const SettingSummary*> ladder;
            const SettingSummary* same = nullptr;
            for (const SettingSummary& s : summaries) {
                if (s.setting.sampler != name) continue;
                ladder.push_back(&s);
                if (drawn(s.setting) == drawn(base.setting) && s.setting.spp == base.setting.spp)
                    same = &s;
            }
            json entry = to_json(base.setting);
            entry["sampler"] = name;
            for (const auto& [key, metric] : metrics) {
                entry["equal_samples"][key] =
                    same ? ratio_json(equal_samples(*same, base, metric)) : json();
                entry["equal_time"][key] = ratio_json(equal_time(ladder, base, metric));
            }
            out.push_back(std::move(entry));
        }
    }
    return out;
}

json images_json(const Chart& chart, const std::vector<ShownImage>& images,
                 const ChartFacts& facts) {
    json out = json::array();
    for (const ShownImage& shown : images) {
        const Setting& s = shown.image->setting;
        json entry = to_json(s);
        const auto run = std::ranges::find(chart.runs, s, &Run::setting);  // of the first seed
        entry["seed"] = run->seed;
        entry["seconds"] = run->rendering.seconds();
        entry["relmse"] = run->difference.relmse;
        entry["mape"] = run->difference.mape;
        entry["equal_samples"] = shown.equal_samples;
        entry["equal_time"] = shown.equal_time;
        entry["errors"] = shown.file;
        entry["command"] = fmt::format(
            "manylight render {} --sampler {} --light-samples {} --spp {} --seed {}{} -o "
            "{}-{}x{}.exr",
            facts.view, s.sampler, s.light_samples, s.spp, run->seed,
            chart.options.whole ? "" : " --pixel-centre --hide-emitters", s.sampler,
            s.light_samples, s.spp);
        out.push_back(std::move(entry));
    }
    return out;
}

// Where the report starts: the middle of the baseline's ladder.
const SettingSummary& start_of(const Chart& chart, const std::vector<SettingSummary>& summaries) {
    const auto middle = [](std::vector<uint> values) {
        std::ranges::sort(values);
        return values[(values.size() - 1) / 2];
    };
    const Setting wanted{chart.options.baseline, middle(chart.options.light_samples),
                         middle(chart.options.spp)};
    const auto found = std::ranges::find(summaries, wanted, &SettingSummary::setting);
    if (found != summaries.end()) return *found;
    return *std::ranges::find(summaries, chart.options.baseline,
                              [](const SettingSummary& s) { return s.setting.sampler; });
}

}  // namespace

std::vector<ShownImage> choose_images(const Chart& chart,
                                      const std::vector<SettingSummary>& summaries) {
    const SettingSummary& start = start_of(chart, summaries);
    std::vector<ShownImage> out;
    for (const std::string& name : chart.options.samplers) {
        const SettingSummary* same = nullptr;
        const SettingSummary* as_fast = nullptr;
        const auto distance = [&](const SettingSummary& s) {
            return std::abs(std::log(s.seconds.median / start.seconds.median));
        };
        for (const SettingSummary& s : summaries) {
            if (s.setting.sampler != name) continue;
            const bool all = find_sampler(name).all_lights;
            if ((all && same == nullptr) ||
                (s.setting.light_samples == start.setting.light_samples &&
                 s.setting.spp == start.setting.spp))
                same = &s;
            if (as_fast == nullptr || distance(s) < distance(*as_fast)) as_fast = &s;
        }
        for (const SettingSummary* chosen : {same, as_fast}) {
            if (chosen == nullptr || (chosen == same && chosen == as_fast && !out.empty() &&
                                      out.back().image->setting == chosen->setting))
                continue;
            const Setting& s = chosen->setting;
            out.push_back({&*std::ranges::find(chart.images, s, &KeptImage::setting),
                           chosen == same, chosen == as_fast,
                           fmt::format("errors-{}-{}x{}.png", s.sampler, s.light_samples, s.spp)});
        }
    }
    return out;
}

json chart_json(const Chart& chart, const Renderer& renderer,
                const std::vector<SettingSummary>& summaries, const std::vector<ShownImage>& images,
                const ChartFacts& facts) {
    const ChartOptions& o = chart.options;
    json out = {{"version", MANYLIGHT_VERSION},
                {"command", facts.command},
                {"scene", facts.scene},
                {"width", renderer.width()},
                {"height", renderer.height()},
                {"device", renderer.device().name},
                {"platform", renderer.device().platform},
                {"driver", renderer.device().driver},
                {"seconds", facts.seconds},
                {"light_samples", o.light_samples},
                {"spp", o.spp},
                {"whole", o.whole},
                {"seeds", o.seeds},
                {"baseline", o.baseline},
                {"start", to_json(start_of(chart, summaries).setting)},
                {"reference", reference_json(chart)},
                {"samplers", samplers_json(chart)},
                {"left_out", left_out_json(chart)},
                {"error_scale", {least_shown_error, largest_shown_error}},
                {"settings", json::array()},
                {"ratios", ratios_json(chart, summaries)},
                {"images", images_json(chart, images, facts)},
                {"runs", json::array()}};
    for (const SettingSummary& s : summaries) out["settings"].push_back(to_json(s));
    for (const Run& run : chart.runs) out["runs"].push_back(to_json(run));
    return out;
}

}  // namespace manylight

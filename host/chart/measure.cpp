// SPDX-License-Identifier: MIT
#include "chart/measure.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>

#include "clock.hpp"
#include "error.hpp"
#include "print.hpp"

namespace manylight {
namespace {

// Seeds of a reference's images, away from those of runs.
constexpr uint reference_seed = 0x80000000u;
constexpr std::size_t fewest_images = 4;  // of a reference that is not exact
// Seeds differ: the dearest setting's error is not the smallest of all.
constexpr double margin = 1.25;

// What a sampler's cheapest and dearest settings took.
struct Pilot {
    Setting setting;
    Rendering rendering;
};

// Seconds that a setting will take, from what another one of its sampler took.
double expected_seconds(const Setting& setting, const Pilot& pilot) {
    return pilot.rendering.start_seconds + pilot.rendering.prepare_seconds +
           pilot.rendering.render_seconds * drawn(setting) / drawn(pilot.setting);
}

std::string in_words(double seconds) {
    if (seconds < 120) return fmt::format("{:.0f} s", seconds);
    return seconds < 7200 ? fmt::format("{:.0f} min", seconds / 60)
                          : fmt::format("{:.1f} h", seconds / 3600);
}

class Measurement {
  public:
    Measurement(Renderer& renderer, const ChartOptions& options)
        : renderer_(renderer),
          out_{.options = options,
               .settings = {},
               .left_out = {},
               .runs = {},
               .images = {},
               .compile_seconds = {},
               .reference = Reference(renderer.width(), renderer.height(), is_exact()),
               .reference_setting = manylight::reference_setting(renderer),
               .reference_file = {}} {}

    Chart run() {
        open_reference();
        warm_up();
        begin_reference();
        choose_settings();
        converge();
        measure();
        return std::move(out_);
    }

  private:
    [[nodiscard]] bool is_exact() const {
        return renderer_.is_exact(find_sampler(manylight::reference_setting(renderer_).sampler));
    }

    // Of the cache, if it is there.
    void open_reference() {
        const std::string folder = reference_folder(out_.options.cache);
        key_ = reference_name(renderer_, out_.reference_setting);
        out_.reference_file = (std::filesystem::path(folder) / key_).string();
        if (!std::filesystem::exists(out_.reference_file)) return;
        try {
            out_.reference = Reference::load(out_.reference_file, key_, renderer_.width(),
                                             renderer_.height(), is_exact());
        } catch (const InputError& error) {
            warn("{}; the reference is made anew", error.what());
        }
        out_.cached_images = out_.reference.count();
    }

    // Compiles, and says what a setting will take.
    void warm_up() {
        Progress progress("compiling", out_.options.quiet);
        double done = 0;
        for (const std::string& name : out_.options.samplers) {
            const Sampler& sampler = find_sampler(name);
            progress.part(done, done + 1.0 / out_.options.samplers.size());
            done += 1.0 / out_.options.samplers.size();
            if (sampler.all_lights) continue;
            const Setting cheapest = ladder_of(sampler, out_.options, renderer_).front();
            for (int i = 0; i < 2; ++i) {  // compiles, then shows its time
                Rendering rendering = renderer_.render(cheapest, out_.options.seed, progress);
                out_.compile_seconds[name] += rendering.compile_seconds;
                pilots_[name] = {cheapest, std::move(rendering)};
            }
        }
    }

    void begin_reference() {
        const std::size_t needed = is_exact() ? 1 : fewest_images;
        if (out_.reference.count() >= needed) return;
        Progress progress("reference", out_.options.quiet);
        while (out_.reference.count() < needed) {
            const auto count = static_cast<double>(out_.reference.count());
            progress.part(count / needed, (count + 1) / needed);
            add_to_reference(progress);
        }
    }

    void add_to_reference(Progress& progress) {
        const auto start = Clock::now();
        const Setting& setting = out_.reference_setting;
        const uint seed = reference_seed + static_cast<uint>(out_.reference.count());
        const Rendering rendering = renderer_.render(setting, seed, progress);
        out_.reference.add(rendering.image, rendering.seconds());
        out_.reference.save(out_.reference_file, key_);
        if (!(out_.reference.luminance().value > 0))
            throw InputError("{}: no light reaches the image: there is nothing to chart",
                             renderer_.scene().file);
        spent_on_reference_ += seconds_since(start);
    }

    // Of all lights: what the reference took, or else as the fastest light samples.
    [[nodiscard]] double expected(const Setting& setting) const {
        const auto pilot = pilots_.find(setting.sampler);
        if (pilot != pilots_.end()) return expected_seconds(setting, pilot->second);
        if (setting.sampler == out_.reference_setting.sampler)
            return out_.reference.seconds() / static_cast<double>(out_.reference.count()) *
                   setting.spp / out_.reference_setting.spp;
        double fastest = std::numeric_limits<double>::infinity();  // of a light sample
        for (const auto& [name, p] : pilots_)
            fastest = std::min(fastest, p.rendering.render_seconds / drawn(p.setting));
        return std::isfinite(fastest) ? fastest * drawn(setting) : 0;
    }

    // The dearest settings say what the others will take, and how good the reference has to be. All
    // lights come last: what they take may be guessed from the others.
    void choose_settings() {
        Progress progress("estimating", out_.options.quiet);
        const auto count = static_cast<double>(out_.options.samplers.size());
        double done = 0;
        for (const bool all_lights : {false, true})
            for (const std::string& name : out_.options.samplers) {
                const Sampler& sampler = find_sampler(name);
                if (sampler.all_lights != all_lights) continue;
                progress.part(done / count, (done + 1) / count);
                ++done;
                choose_settings_of(sampler, progress);
            }
        if (out_.settings.empty())
            throw InputError("--most-seconds {}: no sampler makes an image in that time",
                             out_.options.most_seconds);
        std::ranges::stable_sort(out_.settings, {}, [&](const Setting& s) {
            return std::ranges::find(out_.options.samplers, s.sampler);
        });
        std::string& baseline = out_.options.baseline;
        if (std::ranges::count(out_.settings, baseline, &Setting::sampler) > 0) return;
        warn("--baseline {}: all its settings are left out; {} is taken", baseline,
             out_.settings.front().sampler);
        baseline = out_.settings.front().sampler;
    }

    void choose_settings_of(const Sampler& sampler, Progress& progress) {
        const std::string name(sampler.name);
        const std::vector<Setting> ladder = ladder_of(sampler, out_.options, renderer_);
        const auto fits = [&](const Setting& s) {
            return expected(s) <= out_.options.most_seconds;
        };
        // What a cheap setting took is too much for dear ones: look again after each step up.
        while (!sampler.all_lights) {
            const auto dearest = std::find_if(ladder.rbegin(), ladder.rend(), fits);
            Pilot& pilot = pilots_.at(name);
            if (dearest == ladder.rend() || drawn(*dearest) <= drawn(pilot.setting)) break;
            pilot = {*dearest, renderer_.render(*dearest, out_.options.seed, progress)};
            out_.compile_seconds[name] += pilot.rendering.compile_seconds;
        }
        for (const Setting& s : ladder) {
            if (fits(s)) {
                out_.settings.push_back(s);
                continue;
            }
            out_.left_out.push_back(
                {s, fmt::format("one image would take about {}, more than --most-seconds {}",
                                in_words(expected(s)), out_.options.most_seconds)});
        }
    }

    // The smallest error of an image that does not take all lights. The reference's own error adds
    // to what is found.
    [[nodiscard]] double smallest_error(double own) const {
        const Image reference = out_.reference.image();
        double smallest = std::numeric_limits<double>::infinity();
        for (const auto& [name, pilot] : pilots_) {
            if (find_sampler(name).all_lights) continue;
            const double found =
                compare_images(pilot.rendering.image, reference, name, "the reference").relmse;
            smallest = std::min(smallest, found - own);
        }
        return smallest;
    }

    void converge() {
        Progress progress("reference", out_.options.quiet);
        while (true) {
            const double own = out_.reference.error().relmse;
            const double smallest = smallest_error(own);
            out_.smallest_error = std::isfinite(smallest) ? std::max(smallest, 0.0) : 0;
            const double target = out_.smallest_error / (margin * reference_ratio);
            if (own <= target || !std::isfinite(smallest)) return;
            if (out_.options.reference_seconds > 0 &&
                spent_on_reference_ >= out_.options.reference_seconds)
                return;
            // Errors fall as the inverse of the number of images.
            const auto count = static_cast<double>(out_.reference.count());
            const double share = std::min(1.0, target / own);
            progress.part(share, std::min(1.0, share * (count + 1) / count));
            add_to_reference(progress);
        }
    }

    [[nodiscard]] uint repeats_of(const Setting& setting) const {
        const double fit =
            std::floor(out_.options.most_seconds / std::max(expected(setting), 1e-9));
        return static_cast<uint>(std::clamp<double>(fit, 1, out_.options.seeds));
    }

    // Seed by seed, all settings in turn, so that drifts of the machine hit all alike.
    void measure() {
        Progress progress("measuring", out_.options.quiet);
        const Image reference = out_.reference.image();
        double all = 0;
        for (const Setting& s : out_.settings) all += expected(s) * repeats_of(s);
        double done = 0;
        for (uint round = 0; round < out_.options.seeds; ++round)
            for (const Setting& s : out_.settings) {
                if (round >= repeats_of(s)) continue;
                progress.part(done / all, (done + expected(s)) / all);
                done += expected(s);
                measure_one(s, out_.options.seed + round, reference, progress);
            }
    }

    void measure_one(const Setting& setting, uint seed, const Image& reference,
                     Progress& progress) {
        Run run{setting, seed, renderer_.render(setting, seed, progress), {}, 0};
        run.difference =
            compare_images(run.rendering.image, reference, setting.sampler, "the reference");
        run.luminance = mean_luminance(run.rendering.image);
        if (run.difference.bad > 0)
            throw RuntimeError(
                "{}, sampler {}, {} light samples, {} spp, seed {}: {} is no finite "
                "number",
                renderer_.scene().file, setting.sampler, setting.light_samples, setting.spp, seed,
                place_of_value(run.rendering.image, run.difference.first_bad));
        if (seed == out_.options.seed) out_.images.push_back({setting, pack(run.rendering.image)});
        out_.compile_seconds[setting.sampler] += run.rendering.compile_seconds;
        run.rendering.image = {};
        run.difference.pixels = {};
        out_.runs.push_back(std::move(run));
    }

    Renderer& renderer_;
    Chart out_;
    std::string key_;
    double spent_on_reference_ = 0;        // seconds, now
    std::map<std::string, Pilot> pilots_;  // by sampler
};

}  // namespace

std::vector<Setting> ladder_of(const Sampler& sampler, const ChartOptions& options,
                               const Renderer& renderer) {
    std::vector<uint> light_samples = options.light_samples;
    if (sampler.all_lights)
        light_samples = {
            static_cast<uint>(std::max<std::size_t>(renderer.scene().lights.size(), 1))};
    std::vector<uint> spp = options.spp;
    if (renderer.is_exact(sampler)) spp = {std::ranges::min(spp)};
    std::vector<Setting> out;
    for (const uint s : spp)
        for (const uint n : light_samples) out.push_back({std::string(sampler.name), n, s});
    std::ranges::stable_sort(out, {}, drawn);
    return out;
}

Chart measure_chart(Renderer& renderer, const ChartOptions& options) {
    return Measurement(renderer, options).run();
}

}  // namespace manylight

// SPDX-License-Identifier: MIT
#include "reference/samplers/ward.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "reference/random.hpp"
#include "shared/ward.h"

namespace manylight::reference {
namespace {

constexpr double doubtful = 1e-5;  // of a comparison, relative: single precision may not see it
constexpr double of_all = 1e-6;    // what it makes of a sum that most was taken away from

// A light (its point) that shines on the pixel.
struct Lit {
    uint light;
    Unshadowed direct;
    double size;   // luminance of its contribution
    double slack;  // what rounding may do to that, where asked for
    double share;  // of its rays that pass, by its history
};

double share_of(uint history) { return (history / 65536 + 1.0) / (history % 65536 + 2.0); }

glm::dvec2 point_on(const Light& light, uint index, const PixelDraws& draws) {
    if (!has_area(light)) return glm::dvec2(0);
    const auto bits = random_bits(draws.pixel, draws.pixel_sample, index, draws.seed);
    return {unit_fraction(bits[1]), unit_fraction(bits[2])};
}

// In descending order. Of those that do not shine on the pixel, what rounding may make of it is
// added to the estimate's slack.
std::vector<Lit> lights_of(const Point& point, const PixelDraws& draws,
                           std::span<const uint> histories, Estimate& estimate) {
    std::vector<Lit> out;
    for (uint i = 0; i < point.scene.lights.size(); ++i) {
        const Light& light = point.scene.lights[i];
        const glm::dvec2 u = point_on(light, i, draws);
        const Unshadowed direct =
            unshadowed(point.surface, point.material(), point.viewer, light, u);
        const double size = luminance(direct.value);
        const double slack =
            draws.judge ? rounding_slack(point.surface, point.material(), point.viewer, light, u)
                        : 0;
        if (size <= 0) {
            estimate.slack += slack;
            continue;
        }
        out.push_back({i, direct, size, slack, share_of(histories[i])});
    }
    std::ranges::stable_sort(out, std::greater{}, &Lit::size);
    return out;
}

// A walk down the lights of a pixel.
struct Walk {
    std::size_t tested = 0;
    double expected = 0, hits = 0;  // of the lights tested
};

class PixelWalk {
  public:
    PixelWalk(const Tracer& tracer, std::span<const Lit> lights, bool judge, Estimate& out)
        : tracer_(tracer), lights_(lights), judge_(judge), out_(out) {
        sums_.push_back(0);
        for (const Lit& lit : lights) {
            sums_.push_back(sums_.back() + lit.size);
            slack_ += lit.slack;
        }
    }

    // Tests lights in turn until the next `look_ahead` are below tau times what was seen.
    Walk go(double tau, std::size_t look_ahead) {
        Walk walk;
        double known = 0;
        for (; walk.tested < lights_.size(); ++walk.tested) {
            const std::size_t end = std::min(walk.tested + look_ahead, lights_.size());
            const double rest = sums_[end] - sums_[walk.tested];
            const double limit = tau * known;
            const bool stops = rest < limit;
            if (tau > 0 &&
                std::abs(rest - limit) < doubtful * limit + of_all * sums_.back() + slack_)
                doubt();
            if (stops) {
                check_order(walk.tested);
                break;
            }
            const Lit& lit = lights_[walk.tested];
            const bool visible = look_at(lit);
            walk.expected += lit.share;
            walk.hits += visible ? 1 : 0;
            known += visible ? lit.size : 0;
            add(visible ? lit.direct.value : glm::dvec3(0));
            out_.slack += lit.slack;
        }
        return walk;
    }

    void add(const glm::dvec3& value) {
        out_.value += value;
        out_.magnitude += glm::abs(value);
    }

    [[nodiscard]] bool look_at(const Lit& lit) {
        if (judge_ && tracer_.occlusion_is_borderline(lit.direct.shadow, lit.direct.rounding))
            doubt();
        return !tracer_.occluded(lit.direct.shadow);
    }

    // All that comes after may be otherwise.
    void doubt() {
        out_.uncertain = true;
        ++out_.undecided;
    }

  private:
    // Whether the first light that is left may have come before the last one tested.
    void check_order(std::size_t at) {
        if (at == 0) return;
        const Lit& last = lights_[at - 1];
        const Lit& next = lights_[at];
        if (last.size - next.size < doubtful * last.size + last.slack + next.slack) doubt();
    }

    const Tracer& tracer_;
    std::span<const Lit> lights_;
    bool judge_;
    Estimate& out_;
    std::vector<double> sums_;  // [i] of the first i lights
    double slack_ = 0;
};

}  // namespace

Estimate Ward::estimate(const Tracer& tracer, const Point& point, const PixelDraws& draws) const {
    Estimate out;
    if (point.surface.position.w < 0) return out;
    const std::size_t count = point.scene.lights.size();
    const auto histories =
        std::span(options_.histories).subspan(draws.item / options_.tile_pixels * count, count);
    const std::vector<Lit> lights = lights_of(point, draws, histories, out);
    PixelWalk pixel(tracer, lights, draws.judge, out);
    const auto look_ahead = static_cast<std::size_t>(
        std::lround(std::pow(static_cast<double>(count), options_.certainty)));
    const Walk walk = pixel.go(options_.tau, look_ahead);

    std::vector<Lit> tail(lights.begin() + static_cast<std::ptrdiff_t>(walk.tested), lights.end());
    std::ranges::sort(tail, {}, &Lit::light);
    const auto expected = [&](const Lit& lit) {
        return walk.expected > 0 ? std::min(lit.share * walk.hits / walk.expected, 1.0) : 0;
    };
    const auto weight = [&](const Lit& lit) {
        return lit.size * std::sqrt(expected(lit) * (1 - expected(lit)) + double{TAIL_DOUBT});
    };
    double total = 0;
    for (const Lit& lit : tail) {
        pixel.add(expected(lit) * lit.direct.value);
        out.slack += expected(lit) * lit.slack;
        total += weight(lit);
    }
    if (!options_.draws_tail || tail.empty()) return out;
    // Systematic: draw i is at (i + shift) / draws of all weights.
    const double shift =
        unit_fraction(random_bits(draws.pixel, draws.pixel_sample, RANDOM_TAIL, draws.seed)[0]);
    double passed = 0;
    for (const Lit& lit : tail) {
        const double begin = passed * draws.sample_count / total - shift;
        passed += weight(lit);
        const double end = passed * draws.sample_count / total - shift;
        const double blur = doubtful * draws.sample_count;
        if (&lit != &tail.back() && std::abs(end - std::round(end)) < blur) pixel.doubt();
        // The draws i with begin <= i < end.
        const double times = std::ceil(end) - std::max(std::ceil(begin), 0.0);
        if (times <= 0) continue;
        const double scale = times * total / (draws.sample_count * weight(lit));
        pixel.add(-expected(lit) * scale * lit.direct.value);
        if (pixel.look_at(lit)) pixel.add(scale * lit.direct.value);
        out.slack += scale * lit.slack;
    }
    return out;
}

History hit_history(const Scene& scene, const Tracer& tracer, const Viewers& viewers,
                    std::size_t first, std::span<const Surface> items, uint number, uint light,
                    uint seed) {
    History out;
    const Light& source = scene.lights[light];
    const auto bits = random_bits(number, RANDOM_HISTORIES, light, seed);
    for (uint probe = 0; probe < WARD_PROBES; ++probe) {
        // A random item of the probe's sixteenth.
        const auto random = step_bits(bits[0], probe);
        const std::size_t within = (items.size() * random) >> 32;
        const std::size_t item = (items.size() * probe + within) / WARD_PROBES;
        const Surface& surface = items[item];
        if (surface.position.w < 0) continue;
        const glm::dvec2 u(unit_fraction(step_bits(bits[1], probe)),
                           unit_fraction(step_bits(bits[2], probe)));
        const Material& material = scene.materials[surface.shading];
        const Viewer viewer = viewers.of(first + item);
        const Unshadowed direct = unshadowed(surface, material, viewer, source, u);
        const double size = luminance(direct.value);
        if (size < rounding_slack(surface, material, viewer, source, u)) ++out.undecided;
        if (size <= 0) continue;
        ++out.traced;
        if (tracer.occlusion_is_borderline(direct.shadow, direct.rounding)) ++out.undecided;
        if (!tracer.occluded(direct.shadow)) ++out.passed;
    }
    return out;
}

}  // namespace manylight::reference

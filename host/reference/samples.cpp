// SPDX-License-Identifier: MIT
#include "reference/samples.hpp"

#include "reference/random.hpp"

namespace manylight::reference {

uint stratified(uint total, uint sample, uint count, uint random) {
    const std::uint64_t within = (std::uint64_t{total} * random) >> 32;
    return static_cast<uint>((std::uint64_t{total} * sample + within) / count);
}

Found search(std::span<const uint> cdf, uint target) {
    uint before = 0;
    for (uint light = 0; light < cdf.size(); ++light) {
        if (target < cdf[light]) return {light, cdf[light] - before};
        before = cdf[light];
    }
    return {0, 0};
}

Choice draw_from(std::span<const uint> cdf, const Draw& draw) {
    const uint total = cdf.back();
    if (total == 0) return {0, 0};
    const uint target = stratified(total, draw.sample, draw.sample_count, draw.bits[0]);
    const Found found = search(cdf, target);
    return {found.light, static_cast<double>(total) / found.width / draw.sample_count};
}

double share_of(std::span<const uint> cdf, uint light) {
    const double width = cdf[light] - (light > 0 ? cdf[light - 1] : 0u);
    return cdf.back() > 0 ? width / cdf.back() : 0;
}

std::optional<ExpectedCount> OneLight::expected_count(const Point& point, std::size_t item,
                                                      uint light, uint sample_count) const {
    const std::optional<double> p = probability(point, item, light);
    if (!p) return {};
    return ExpectedCount{{{1, *p * sample_count}}};
}

Estimate OneLight::estimate(const Tracer& tracer, const Point& point,
                            const PixelDraws& draws) const {
    Estimate out;
    if (point.surface.position.w < 0) return out;
    const auto lights = static_cast<uint>(point.scene.lights.size());
    const bool closed_form = probability(point, draws.item, 0).has_value();
    for (uint sample = 0; sample < draws.sample_count; ++sample) {
        const auto bits = random_bits(draws.pixel, draws.pixel_sample, sample, draws.seed);
        const Choice choice =
            choose(point, {draws.item, sample, draws.sample_count, bits, lights, draws.judge});
        out.uncertain = out.uncertain || choice.borderline;
        out.undecided += choice.borderline ? 1 : 0;
        if (choice.weight == 0) continue;
        const Light& light = point.scene.lights[choice.light];
        const glm::dvec2 u(unit_fraction(bits[1]), unit_fraction(bits[2]));
        const double count = closed_form ? 1 / choice.weight : 1;
        const Unshadowed term =
            unshadowed(point.surface, point.material(), point.viewer, light, u, count);
        if (draws.judge)
            out.slack += choice.weight * rounding_slack(point.surface, point.material(),
                                                        point.viewer, light, u, count);
        if (term.value == glm::dvec3(0)) continue;
        const glm::dvec3 value = term.value * choice.weight;
        // The share changes by up to twice as much as the weight, relatively.
        out.slack += (closed_form ? 3 : 1) * choice.slack * glm::length(value);
        if (!tracer.occluded(term.shadow)) {
            out.value += value;
            out.magnitude += value;
        }
        if (draws.judge && tracer.occlusion_is_borderline(term.shadow, term.rounding)) {
            out.borderline += glm::length(value);
            ++out.undecided;
        }
    }
    return out;
}

}  // namespace manylight::reference

// SPDX-License-Identifier: MIT
#include "reference/samples.hpp"

#include "reference/random.hpp"

namespace manylight::reference {
namespace {

// (sample + random / 2^32) / count of `total`: stratified.
uint stratified(uint total, uint sample, uint count, uint random) {
    const std::uint64_t within = (std::uint64_t{total} * random) >> 32;
    return static_cast<uint>((std::uint64_t{total} * sample + within) / count);
}

Choice draw(std::span<const uint> cdf, uint sample, uint count, uint random) {
    const uint total = cdf.back();
    if (total == 0) return {0, 0};
    const uint target = stratified(total, sample, count, random);
    uint before = 0;
    for (uint light = 0; light < cdf.size(); ++light) {
        if (target < cdf[light])
            return {light, static_cast<double>(total) / (cdf[light] - before) / count};
        before = cdf[light];
    }
    return {0, 0};
}

}  // namespace

Choice choose_exhaustive(const Tables&, std::size_t, uint sample, uint, uint, uint) {
    return {sample, 1};
}

Choice choose_uniform(const Tables&, std::size_t, uint sample, uint count, uint random,
                      uint lights) {
    return {stratified(lights, sample, count, random), static_cast<double>(lights) / count};
}

Choice choose_power(const Tables& tables, std::size_t, uint sample, uint count, uint random, uint) {
    return draw(tables.power_cdf, sample, count, random);
}

Choice choose_contribution(const Tables& tables, std::size_t item, uint sample, uint count,
                           uint random, uint lights) {
    return draw(tables.cdf.subspan(std::size_t{tables.item_rows[item]} * lights, lights), sample,
                count, random);
}

Estimate estimate(const Scene& scene, const Tracer& tracer, const Camera& camera,
                  const Surface& surface, const Tables& tables, ChooseLight choose,
                  std::size_t item, uint pixel, uint pixel_sample, uint seed, uint sample_count,
                  bool judge) {
    Estimate out{glm::dvec3(0), glm::dvec3(0)};
    if (surface.position.w < 0) return out;
    const Material& material = scene.materials[surface.material];
    const auto lights = static_cast<uint>(scene.lights.size());
    for (uint sample = 0; sample < sample_count; ++sample) {
        const auto bits = random_bits(pixel, pixel_sample, sample, seed);
        const Choice choice = choose(tables, item, sample, sample_count, bits[0], lights);
        if (choice.weight == 0) continue;
        const Light& light = scene.lights[choice.light];
        const glm::dvec2 u(unit_fraction(bits[1]), unit_fraction(bits[2]));
        const Unshadowed term = unshadowed(surface, material, camera, light, u);
        if (judge) out.slack += choice.weight * rounding_slack(surface, material, camera, light, u);
        if (term.value == glm::dvec3(0)) continue;
        const glm::dvec3 value = term.value * choice.weight;
        if (!tracer.occluded(term.shadow)) {
            out.value += value;
            out.magnitude += value;
        }
        if (judge && tracer.occlusion_is_borderline(term.shadow, end_rounding(term.shadow)))
            out.borderline += glm::length(value);
    }
    return out;
}

}  // namespace manylight::reference

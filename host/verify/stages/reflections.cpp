// SPDX-License-Identifier: MIT
// Stage reflections.
#include "stages/reflections.hpp"

#include <cmath>

#include "reference/reflections.hpp"
#include "reference/tiles.hpp"
#include "verify/sampler_checks.hpp"
#include "verify/stages.hpp"
#include "verify/tolerances.hpp"

namespace manylight {
namespace {

// With as many light samples as take several rounds of all samplers.
Check reflections(Verifier& verifier, const Sampler* sampler) {
    Check check{.stage = sampler ? fmt::format("reflections ({})", sampler->name) : "reflections",
                .tolerance = "64 eps (40 operations) + change under 16 eps shifts of the ray"};
    if (verifier.device_scene().shading.at("HAS_REFLECTIONS") == 0) return check;
    const PixelSample sample{2, verifier.options().seed, false};
    const uint light_samples = 40;
    // On top of other light: what is there stays.
    const float there = 0x1p-10f;
    Buffer<float4> estimates =
        verifier.device().upload(std::vector<float4>(item_count(verifier.tiles()), float4(there)));
    verifier.send_out(verifier.found_surfaces());
    std::unique_ptr<LightSampler> drawing;
    std::unique_ptr<reference::Sampler> judge_sampler;
    const reference::OneLight* one_light = nullptr;
    if (sampler) {
        drawing =
            sampler->make({verifier.device(), verifier.device_scene(*sampler), verifier.lights(),
                           verifier.tiles().count, verifier.tiles().size, verifier.options().width,
                           light_samples, verifier.options().clusters, values_of(*sampler)});
        drawing->prepare();
        drawing->begin(verifier.tiles(), verifier.surfaces(), verifier.options().seed,
                       [](std::size_t) {});
        judge_sampler =
            checks_of(*sampler).reference(*drawing, {verifier.scene(), verifier.tree()});
        one_light = dynamic_cast<const reference::OneLight*>(judge_sampler.get());
    }
    ReflectionStage(verifier.device(),
                    sampler ? verifier.device_scene(*sampler) : verifier.device_scene(),
                    item_count(verifier.tiles()), sampler ? sampler->closed_form : "")
        .add(verifier.tiles(), sample, light_samples, verifier.surfaces(),
             sampler ? drawing->tables() : Arguments(), estimates);
    const std::vector<float4> found = estimates.download();
    reference::for_each_pixel(verifier.tiles(), [&](uint x, uint y, std::size_t item) {
        reference::CountOf count_of;
        if (one_light)
            count_of = [&](uint light) {
                return *one_light->expected_count({verifier.scene(), verifier.viewers().of(item),
                                                   verifier.found_surfaces()[item]},
                                                  item, light, light_samples);
            };
        const auto judge = [&](bool closely) {
            return reference::reflection(
                verifier.scene(), verifier.tracer(), verifier.viewers().of(item),
                verifier.found_surfaces()[item], y * verifier.tiles().width + x, sample.index,
                sample.seed, closely, count_of);
        };
        reference::Reflection expected = judge(false);
        const auto difference = [&] {
            return glm::length(glm::dvec4(found[item]) - glm::dvec4(expected.value, 0) -
                               double{there});
        };
        double tolerance =
            shading_roundings * epsilon * (glm::length(expected.value) + double{there});
        if (difference() > tolerance / 4) {
            expected = judge(true);
            tolerance += expected.slack;
            if (difference() > tolerance && expected.borderline) return check.skip_borderline();
        }
        check.compare(
            difference(), tolerance,
            fmt::format("pixel ({}, {}): {} is not {}", x, y,
                        show(glm::dvec3(found[item]) - glm::dvec3(there)), show(expected.value)),
            found[item].r == there && expected.value.r == 0);
    });
    return check;
}

// Beside no sampler, and beside each that has a closed form.
std::vector<Check> all_reflections(Verifier& verifier) {
    std::vector<Check> checks = {reflections(verifier, nullptr)};
    for (const Sampler& sampler : all_samplers())
        if (!sampler.closed_form.empty()) checks.push_back(reflections(verifier, &sampler));
    return checks;
}

}  // namespace

StageCheck check_reflections() {
    return {
        .stages = {"reflections"}, .orthographic = true, .receivers = true, .run = all_reflections};
}

}  // namespace manylight

// SPDX-License-Identifier: MIT
// Stage reflections.
#include "stages/reflections.hpp"

#include <cmath>

#include "reference/reflections.hpp"
#include "reference/tiles.hpp"
#include "verify/stages.hpp"
#include "verify/tolerances.hpp"

namespace manylight {
namespace {

Check reflections(Verifier& verifier) {
    Check check{.stage = "reflections",
                .tolerance = "64 eps (40 operations) + change under 16 eps shifts of the ray"};
    if (verifier.device_scene().shading.at("HAS_REFLECTIONS") == 0) return check;
    const PixelSample sample{2, verifier.options().seed, false};
    // On top of other light: what is there stays.
    const float there = 0x1p-10f;
    Buffer<float4> estimates =
        verifier.device().upload(std::vector<float4>(item_count(verifier.tiles()), float4(there)));
    verifier.send_out(verifier.found_surfaces());
    ReflectionStage(verifier.device(), verifier.device_scene())
        .add(verifier.tiles(), sample, verifier.surfaces(), estimates);
    const std::vector<float4> found = estimates.download();
    reference::for_each_pixel(verifier.tiles(), [&](uint x, uint y, std::size_t item) {
        const auto judge = [&](bool closely) {
            return reference::reflection(
                verifier.scene(), verifier.tracer(), verifier.viewers().of(item),
                verifier.found_surfaces()[item], y * verifier.tiles().width + x, sample.index,
                sample.seed, closely);
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

}  // namespace

StageCheck check_reflections() {
    return {.stages = {"reflections"},
            .orthographic = true,
            .receivers = true,
            .run = single<reflections>};
}

}  // namespace manylight

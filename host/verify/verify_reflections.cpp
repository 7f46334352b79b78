// SPDX-License-Identifier: MIT
// Stage reflections.
#include <cmath>

#include "reference/reflections.hpp"
#include "reference/tiles.hpp"
#include "stages/reflections.hpp"
#include "verify/tolerances.hpp"
#include "verify/verify.hpp"

namespace manylight {

Check Verifier::reflections() {
    Check check{.stage = "reflections",
                .tolerance = "64 eps (40 operations) + change under 16 eps shifts of the ray"};
    if (device_scene_.shading.at("HAS_REFLECTIONS") == 0) return check;
    const PixelSample sample{2, options_.seed, false};
    // On top of other light: what is there stays.
    const float there = 0x1p-10f;
    Buffer<float4> estimates =
        device_.upload(std::vector<float4>(item_count(tiles_), float4(there)));
    send_out(found_);
    ReflectionStage(device_, device_scene_).add(tiles_, sample, surfaces_, estimates);
    const std::vector<float4> found = estimates.download();
    reference::for_each_pixel(tiles_, [&](uint x, uint y, std::size_t item) {
        const auto judge = [&](bool closely) {
            return reference::reflection(scene_, tracer_, view_.of(item), found_[item],
                                         y * tiles_.width + x, sample.index, sample.seed, closely);
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

}  // namespace manylight

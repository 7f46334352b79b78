// SPDX-License-Identifier: MIT
// Stage emitter_parts.
#include "stages/emitter_parts.hpp"

#include "reference/emitter_parts.hpp"
#include "reference/tiles.hpp"
#include "verify/stages.hpp"
#include "verify/tolerances.hpp"

namespace manylight {
namespace {

void check_light(Verifier& verifier, Check& check, const EmitterParts& found, uint number,
                 const PixelSample& sample, const glm::dvec3& light) {
    const EmitterPart& part = found.parts[number];
    const reference::PartLight expected =
        reference::part_light(verifier.scene(), verifier.camera(), verifier.tiles(), part, number,
                              found.stride, sample.index, sample.seed);
    const glm::dvec3 none(0);
    const bool hidden = verifier.tracer().occluded(expected.shadow);
    const glm::dvec3 value = hidden ? none : expected.value;
    if ((light == none) != (value == none) && expected.value != none &&
        verifier.tracer().occlusion_is_borderline(expected.shadow, expected.rounding))
        return check.skip_borderline();
    const double difference = glm::length(light - value);
    const double tolerance = shading_roundings * epsilon * glm::length(value) + expected.slack;
    check.compare(difference, tolerance,
                  fmt::format("part {} of triangle {} in pixel ({}, {}): {} is not {}", number,
                              part.triangle, part.pixel % verifier.tiles().width,
                              part.pixel / verifier.tiles().width, show(light), show(value)),
                  light == none && value == none);
}

// The sums are compared with those of what was found for each part.
void check_pixels(Verifier& verifier, Check& check, const EmitterParts& found, uint first,
                  const std::vector<float4>& light, const std::vector<Surface>& surfaces,
                  const std::vector<float4>& seen) {
    reference::for_each_pixel(verifier.tiles(), [&](uint x, uint y, std::size_t item) {
        const uint pixel = y * verifier.tiles().width + x;
        glm::dvec3 sum(0);
        bool counts = true;
        for (uint k = found.pixel_parts[pixel]; k < found.pixel_parts[pixel + 1]; ++k) {
            if (k % found.stride == first) sum += glm::dvec3(light[k / found.stride]);
            if (surfaces[item].position.w >= 0 &&
                surfaces[item].triangle == found.parts[k].triangle)
                counts = false;
        }
        const std::string name = fmt::format("pixel ({}, {})", x, y);
        check.compare(glm::length(glm::dvec3(seen[item]) - sum), 16 * epsilon * glm::length(sum),
                      fmt::format("{}: {} is not {}", name, show(seen[item]), show(sum)),
                      sum == glm::dvec3(0));
        check.compare_exact(seen[item].w == (counts ? 1 : 0), name + ": its own ray's part");
    });
}

// Of a camera's emitters, all drawn, or each in every third sample.
Check emitter_parts(Verifier& verifier) {
    Check check{.stage = "emitter_parts", .tolerance = shading_tolerance};
    const Tiles& tiles = verifier.tiles();
    EmitterParts found =
        find_emitter_parts(verifier.scene(), verifier.camera(), tiles.width, tiles.height);
    if (found.empty()) return check;
    for (const uint stride : {1u, 3u}) {
        found.stride = stride;
        EmitterPartStage stage(verifier.device(), verifier.device_scene(), found);
        Buffer<float4> seen = verifier.device().allocate<float4>(item_count(tiles));
        for (const uint index : {0u, 5u}) {
            const PixelSample sample{index, verifier.options().seed, true};
            const Buffer<Surface> surfaces = verifier.trace(tiles, sample);
            stage.trace(tiles, sample, surfaces, seen);
            const std::vector<float4> light = stage.light().download();
            reference::for_each_pixel(tiles, [&](uint x, uint y, std::size_t) {
                const uint pixel = y * tiles.width + x;
                for (uint k = found.pixel_parts[pixel]; k < found.pixel_parts[pixel + 1]; ++k)
                    if (k % stride == stage.first())
                        check_light(verifier, check, found, k, sample,
                                    glm::dvec3(light[k / stride]));
            });
            check_pixels(verifier, check, found, stage.first(), light, surfaces.download(),
                         seen.download());
        }
    }
    return check;
}

}  // namespace

StageCheck check_emitter_parts() {
    return {.stages = {"emitter_parts"}, .orthographic = true, .run = single<emitter_parts>};
}

}  // namespace manylight

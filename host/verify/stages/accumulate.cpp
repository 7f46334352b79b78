// SPDX-License-Identifier: MIT
// Stage accumulate.
#include "stages/accumulate.hpp"

#include <cmath>

#include "reference/accumulate.hpp"
#include "reference/tiles.hpp"
#include "shared/adaptive.h"
#include "verify/stages.hpp"
#include "verify/tolerances.hpp"

namespace manylight {
namespace {

// `by_passes`: half of the pixels at a time, as sampler adaptive does. `parts`: with what stage
// emitter_parts might have seen.
void accumulate(Verifier& verifier, Check& check, bool grouped, bool by_passes, bool parts) {
    const Tiles tiles = by_passes ? middle_tiles(verifier.options().width,
                                                 verifier.options().height, ADAPTIVE_TILE, 9)
                                  : verifier.tiles();
    const Buffer<Surface> surfaces = verifier.trace(tiles, {});
    const std::vector<Surface> points = surfaces.download();
    const std::size_t pixels = std::size_t{tiles.width} * tiles.height;
    ImageSum image(verifier.device(), pixels, grouped);
    image.sums.upload(std::vector<float4>(pixels, float4(1e6f, 2, 3, 4)));
    DeviceScene scene = verifier.device_scene();
    scene.emission["HAS_EMITTER_PARTS"] = parts;
    AccumulateStage stage(verifier.device(), scene, grouped);
    std::vector<float4> seen(item_count(tiles), float4(0, 0, 0, 1));
    if (parts)
        for (std::size_t i = 0; i < seen.size(); ++i) seen[i] = float4(i % 3, 0.5f, 0.25f, i % 2);
    const Buffer<float4> uploaded_seen = verifier.device().upload(seen);
    std::vector<glm::dvec4> expected(pixels, glm::dvec4(1e6f, 2, 3, 4));
    std::vector<glm::dvec4> groups(ERROR_GROUPS * pixels, glm::dvec4(0));
    double weights = 0;
    for (uint sample = 0; sample < 5; ++sample) {
        std::vector<float4> estimates(item_count(tiles));
        for (std::size_t i = 0; i < estimates.size(); ++i)
            estimates[i] = float4(0.013f * static_cast<float>((i + 31 * sample) % 97), 2, 1e-6f, 3);
        const float weight = sample < 2 ? 1.f : 4.f;
        const Buffer<float4> uploaded = verifier.device().upload(estimates);
        const SampleWeight weighed{weight, sample % ERROR_GROUPS};
        if (by_passes)
            for (const uint first : {0u, 8u})
                stage.add(tiles, Pass{first, 8, 0, 0, tiles.count, 1}, surfaces, uploaded,
                          uploaded_seen, weighed, image);
        else
            stage.add(tiles, {}, surfaces, uploaded, uploaded_seen, weighed, image);
        weights += weight;
        reference::for_each_pixel(tiles, [&](uint x, uint y, std::size_t item) {
            const std::size_t pixel = std::size_t{y} * tiles.width + x;
            const glm::dvec4 value = glm::dvec4(weight, weight, weight, 1) *
                                     reference::pixel_sample_value(points[item], estimates[item],
                                                                   verifier.scene(), seen[item]);
            expected[pixel] += value;
            groups[ERROR_GROUPS * pixel + sample % ERROR_GROUPS] +=
                glm::dvec4(glm::dvec3(value), weight);
        });
    }
    const std::vector<float4> found = image.sums.download();
    const std::vector<float4> found_groups =
        grouped ? image.groups.download() : std::vector<float4>{};
    const std::vector<float> found_weights = image.weights.download();
    reference::for_each_pixel(tiles, [&](uint x, uint y, std::size_t) {
        const std::size_t pixel = std::size_t{y} * tiles.width + x;
        const std::string name = fmt::format("pixel ({}, {})", x, y);
        check.compare_exact(found_weights[pixel] == weights, name + ": weight");
        for (int c = 0; c < 4; ++c) {
            check.compare(std::abs(found[pixel][c] - expected[pixel][c]),
                          2 * epsilon * expected[pixel][c], fmt::format("{}, channel {}", name, c));
            if (!grouped) continue;
            for (uint g = 0; g < ERROR_GROUPS; ++g) {
                const double sum = groups[ERROR_GROUPS * pixel + g][c];
                check.compare(std::abs(found_groups[ERROR_GROUPS * pixel + g][c] - sum),
                              4 * epsilon * sum,
                              fmt::format("{}, channel {}: group {}", name, c, g));
            }
        }
    });
}

Check accumulate(Verifier& verifier) {
    Check check{.stage = "accumulate", .tolerance = "2 eps of the sum (compensated)"};
    const bool emission = verifier.device_scene().emission.at("HAS_EMISSION") != 0;
    for (const bool grouped : {true, false})
        for (const bool by_passes : {false, true}) {
            accumulate(verifier, check, grouped, by_passes, false);
            if (emission) accumulate(verifier, check, grouped, by_passes, true);
        }
    return check;
}

}  // namespace

StageCheck check_accumulate() { return {.stages = {"accumulate"}, .run = single<accumulate>}; }

}  // namespace manylight

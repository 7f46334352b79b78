// SPDX-License-Identifier: MIT
#include "reference/samplers/ward.hpp"

#include "reference/tiles.hpp"
#include "samplers/ward/ward.hpp"
#include "verify/sampler_checks.hpp"
#include "verify/tolerances.hpp"

namespace manylight {
namespace {

std::unique_ptr<reference::Sampler> make_reference(const LightSampler& sampler,
                                                   const CheckContext& /*context*/) {
    const auto& ward = dynamic_cast<const Ward&>(sampler);
    const std::size_t side = ward.tiles().size;
    return std::make_unique<reference::Ward>(reference::WardOptions{.tau = ward.tau(),
                                                                    .certainty = ward.certainty(),
                                                                    .draws_tail = false,
                                                                    .tile_pixels = side * side,
                                                                    .histories = ward.histories()});
}

// Surfaces at the pixels' centres, with none where an item is outside the image.
std::vector<Surface> surfaces_in_image(const Verifier& verifier) {
    std::vector<Surface> out(verifier.found_surfaces().size());
    for (Surface& surface : out) surface.position.w = -1;
    reference::for_each_pixel(verifier.tiles(), [&](uint, uint, std::size_t item) {
        out[item] = verifier.found_surfaces()[item];
    });
    return out;
}

// Stage histories: of some lights in some tiles, the rays traced and passed.
Check check_histories(Verifier& verifier, const Sampler& sampler) {
    Check check{.stage = fmt::format("histories ({})", sampler.name), .tolerance = exact};
    const std::size_t lights = verifier.lights().size();
    if (lights == 0) return check;
    const Tiles& tiles = verifier.tiles();
    const VerifyOptions& options = verifier.options();
    Ward ward({verifier.device(), verifier.device_scene(sampler), verifier.lights(), tiles.count,
               tiles.size, options.width, 1, options.clusters, values_of(sampler)});
    ward.begin(tiles, verifier.surfaces(), options.seed, [](std::size_t) {});
    const std::vector<uint> found = ward.histories();
    const std::vector<Surface> surfaces = surfaces_in_image(verifier);
    const std::size_t area = std::size_t{tiles.size} * tiles.size;
    const std::size_t stride = found.size() * 16 / options.most_entries | 1;
    for (std::size_t i = 0; i < found.size(); i += stride) {
        const auto tile = static_cast<uint>(i / lights);
        const reference::History expected =
            reference::hit_history(verifier.scene(), verifier.tracer(), verifier.viewers(),
                                   tile * area, std::span(surfaces).subspan(tile * area, area),
                                   tiles.first + tile, static_cast<uint>(i % lights), options.seed);
        const uint history = expected.traced + 65536 * expected.passed;
        check.excuse(static_cast<int>(expected.undecided));
        if (found[i] != history && expected.undecided > 0) {
            check.skip_borderline();
            continue;
        }
        check.compare(
            found[i] == history ? 0 : 2, 1,
            fmt::format("tile {}, light {}: {} of {} rays passed, not {} of {}", tile, i % lights,
                        found[i] >> 16, found[i] & 0xffff, expected.passed, expected.traced),
            history == 0 && found[i] == 0);
    }
    return check;
}

}  // namespace

SamplerChecks checks_ward() {
    return {.reference = make_reference,
            .stages = {"histories", "samples"},
            .run = [](Verifier& verifier, const Sampler& sampler) -> std::vector<Check> {
                return {check_histories(verifier, sampler), check_estimates(verifier, sampler)};
            }};
}

}  // namespace manylight

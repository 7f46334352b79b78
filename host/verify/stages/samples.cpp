// SPDX-License-Identifier: MIT
// Stage samples, of all samplers whose pixels do not depend on each other's draws.
#include <cmath>

#include "reference/samples.hpp"
#include "reference/tiles.hpp"
#include "verify/sampler_checks.hpp"
#include "verify/tolerances.hpp"

namespace manylight {
namespace {

constexpr std::size_t most_samples = std::size_t{1} << 23;

// Where all lights are drawn and they are many, a tile of 8 x 8 pixels of which all hit the scene,
// as near to the middle as may be; otherwise all tiles.
Tiles tiles_to_sample(Verifier& verifier, uint light_samples) {
    if (item_count(verifier.tiles()) * light_samples <= most_samples) return verifier.tiles();
    Tiles tiles = all_tiles(verifier.options().width, verifier.options().height, 8);
    const uint count = tiles.count;
    tiles.count = 1;
    for (uint i = 0; i < count; ++i) {
        tiles.first = (count / 2 + (i % 2 ? count - (i + 1) / 2 : i / 2)) % count;
        bool inside = true;
        reference::for_each_pixel(tiles, [&](uint x, uint y, std::size_t) {
            const uint tile =
                y / verifier.tiles().size * verifier.tiles().columns + x / verifier.tiles().size;
            inside =
                inside && tile >= verifier.tiles().first &&
                tile < verifier.tiles().first + verifier.tiles().count &&
                verifier.found_surfaces()[reference::item_of(verifier.tiles(), x, y)].position.w >=
                    0;
        });
        if (inside) break;
    }
    return tiles;
}

}  // namespace

Check check_estimates(Verifier& verifier, const Sampler& sampler) {
    Check check{.stage = fmt::format("samples ({})", sampler.name), .tolerance = shading_tolerance};
    if (verifier.scene().lights.empty()) return check;
    const auto lights = static_cast<uint>(verifier.scene().lights.size());
    const uint count = sampler.all_lights ? lights : 20;  // several launches
    const Tiles tiles = tiles_to_sample(verifier, count);
    const DeviceScene& uploaded = verifier.device_scene(sampler);
    const std::unique_ptr<LightSampler> drawing = sampler.make(
        {verifier.device(), uploaded, verifier.scene().lights,
         std::max(tiles.count, verifier.tiles().count), std::max(tiles.size, verifier.tiles().size),
         verifier.options().width, count, verifier.options().clusters, values_of(sampler)});
    drawing->prepare();
    verifier.send_out(verifier.found_surfaces());
    if (!sampler.all_lights)
        drawing->begin(verifier.tiles(), verifier.surfaces(), verifier.options().seed,
                       [](std::size_t) {});
    const std::unique_ptr<reference::Sampler> judge_sampler =
        checks_of(sampler).reference(*drawing, {verifier.scene(), verifier.tree()});
    const PixelSample sample{2, verifier.options().seed, false};
    Buffer<Surface> surfaces = verifier.trace(tiles, {});
    const std::vector<Surface> points = surfaces.download();
    verifier.send_out(points);
    Estimates estimates{verifier.device().allocate<float4>(item_count(tiles)),
                        verifier.device().allocate<float4>(item_count(tiles))};
    drawing->draw(tiles, sample, count, surfaces, estimates,
                  [](const auto&, std::size_t) { return true; });
    const std::vector<float4> found = estimates.sums.download();
    const uint entries = sampler.own_rays ? std::max(count, lights) : count;  // of a pixel, at most
    const std::size_t pixels = std::max<std::size_t>(verifier.options().most_entries / entries, 4);
    const std::size_t stride = pixel_count(tiles) / pixels | 1;
    struct Pixel {
        uint x, y;
        std::size_t item;
    };
    const auto judge_pixel = [&](uint x, uint y, std::size_t item, bool closely) {
        return judge_sampler->estimate(
            verifier.tracer(), {verifier.scene(), verifier.viewers().of(item), points[item]},
            {item, y * tiles.width + x, sample.index, sample.seed, count, closely});
    };
    std::vector<Pixel> agreeing;
    std::size_t next = 0;
    reference::for_each_pixel(tiles, [&](uint x, uint y, std::size_t item) {
        if (next++ % stride != 0) return;
        const auto judge = [&](bool closely) { return judge_pixel(x, y, item, closely); };
        reference::Estimate expected = judge(false);
        const auto difference = [&] {
            return glm::length(glm::dvec3(found[item]) - expected.value);
        };
        double tolerance = (shading_roundings + 2) * epsilon * glm::length(expected.magnitude);
        if (difference() > tolerance / 4) {
            expected = judge(true);
            tolerance += expected.slack;
            if (difference() > tolerance &&
                (expected.uncertain || difference() <= tolerance + expected.borderline)) {
                check.excuse(expected.undecided);
                return check.skip_borderline();
            }
        }
        if (difference() <= tolerance) agreeing.push_back({x, y, item});
        check.compare(difference(), tolerance,
                      fmt::format("pixel ({}, {}): {} is not {}", x, y, show(found[item]),
                                  show(expected.value)),
                      found[item].r == 0 && expected.value.r == 0);
    });
    check.excuse_agreeing(agreeing.size(), [&](std::size_t i) {
        const auto [x, y, item] = agreeing[i];
        return judge_pixel(x, y, item, true).undecided;
    });
    return check;
}

}  // namespace manylight

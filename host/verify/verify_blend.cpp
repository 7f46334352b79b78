// SPDX-License-Identifier: MIT
// What rays pass by chance: no ray of it can be judged alone, but how many pass can.
#include <fmt/format.h>

#include <cmath>

#include "shared/adaptive.h"
#include "stages/gbuffer.hpp"
#include "stages/samples.hpp"
#include "verify/scenes.hpp"
#include "verify/verify_all.hpp"

namespace manylight {
namespace {

constexpr float alpha = 0.3f;
constexpr unsigned side = 32;
constexpr uint samples = 16;
constexpr uint floor_triangles = 2;  // the first of the scene; the shade's follow

}  // namespace

void compare_share(Check& check, double count, double trials, double chance,
                   const std::string& what) {
    const double deviation = std::sqrt(trials * chance * (1 - chance));
    check.compare(std::abs(count - chance * trials), 5 * deviation,
                  fmt::format("{}: {} of {}, not {} in all", what, count, trials, chance));
}

std::vector<Check> check_blend(Device device, uint seed) {
    Check hits{.stage = "gbuffer (by chance)", .tolerance = "5 standard deviations"};
    Check light{.stage = "samples (by chance)", .tolerance = "5 standard deviations"};
    const VerifyScene made = blend_scene(alpha);
    const Tiles tiles = all_tiles(side, side, ADAPTIVE_TILE);
    for (const View& view : {made.view, without_perspective(made.view)}) {
        const Camera camera = make_camera(view, side, side);
        const unsigned lanes = device.form().bvh_width;
        const WideBvh bvh = build_wide_bvh(made.scene, lanes, lanes, reach_of(made.scene, camera));
        const DeviceScene scene = upload_scene(device, made.scene, bvh, camera);
        SampleStage draw(device, scene, "samplers/exhaustive/exhaustive.cl", item_count(tiles));
        double shades = 0;
        double floors = 0;
        double lit = 0;
        std::vector<uint> of_pixel(item_count(tiles));  // how often its ray met the shade
        for (uint index = 0; index < samples; ++index) {
            const PixelSample sample{index, seed, false};
            Buffer<Surface> surfaces = device.allocate<Surface>(item_count(tiles));
            GBufferStage(device, scene).trace(tiles, sample, surfaces);
            Estimates sums{device.allocate<float4>(item_count(tiles)),
                           device.allocate<float4>(item_count(tiles))};
            draw.draw(tiles, sample, 1, surfaces, {}, sums, [](std::size_t) { return true; });
            const std::vector<Surface> found = surfaces.download();
            const std::vector<float4> estimates = sums.sums.download();
            for (std::size_t i = 0; i < found.size(); ++i) {
                const bool shade = found[i].triangle >= floor_triangles;
                of_pixel[i] += shade ? 1 : 0;
                shades += shade ? 1 : 0;
                floors += shade ? 0 : 1;
                lit += !shade && estimates[i].x > 0 ? 1 : 0;
            }
        }
        const std::string camera_name = view.orthographic ? "orthographic" : "perspective";
        compare_share(hits, shades, shades + floors, alpha, camera_name + ": rays that meet it");
        double alike = 0;  // pixels of which all samples are
        for (const uint count : of_pixel) alike += count == 0 || count == samples ? 1 : 0;
        compare_share(hits, alike, static_cast<double>(of_pixel.size()),
                      std::pow(alpha, samples) + std::pow(1 - alpha, samples),
                      camera_name + ": pixels without both");
        compare_share(light, lit, floors, 1 - alpha, camera_name + ": shadow rays that pass");
    }
    return {hits, light};
}

}  // namespace manylight

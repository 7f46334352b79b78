// SPDX-License-Identifier: MIT
#include "verify/samplers/adaptive/run.hpp"

namespace manylight::adaptive_stages {

namespace {

const uint place_order[16] = {12, 0, 4, 8, 3, 7, 11, 15, 1, 2, 5, 6, 9, 10, 13, 14};

}  // namespace

Run::Run(Device& device, const DeviceScene& scene, Tiles all, uint cut_size, uint seed,
         std::size_t first_point, const std::function<void(const std::vector<Surface>&)>& ready)
    : lanes(device.form().pixels), tiles(all), sample{3, seed, false} {
    tiles.count = std::min(tiles.count, most_tiles);
    first.tile_count = second.tile_count = tiles.count;
    Buffer<Surface> points = device.allocate<Surface>(item_count(tiles));
    GBufferStage(device, scene).trace(tiles, {}, points, first_point);
    surfaces = points.download();
    ready(surfaces);
    Cuts cuts(device, tiles.count);
    CutStage(device, scene).make(tiles, points, {cut_size, PROBE_RAYS, seed}, cuts);
    nodes = cuts.nodes.download();
    sizes = cuts.sizes.download();
    probes = cuts.probes.download();
    slots = Visibility::slots(scene.light_count);
    Visibility visibility(device, scene.light_count, tiles.count, tiles.count);
    VisibilityStage learn(device, scene);
    visibility.counts.clear();
    learn.sum(tiles, cuts, visibility);
    learn.estimate(0, tiles.count, cuts, visibility);
    AdaptiveStage stage(device, scene, pass_pixels(first) * first.packets, pass_pixels(first));
    Estimates sums{device.allocate<float4>(item_count(tiles)), {}};
    stage.draw(tiles, first, {budget.samples, 0, 0}, sample, points, cuts, visibility, 1, true,
               sums);
    first_drawn = stage.drawn(first);
    learn.learn(first, stage.draws(), visibility);
    learn.sum(tiles, cuts, visibility);
    learn.estimate(0, tiles.count, cuts, visibility);
    counts = visibility.counts.download();
    visible = visibility.visible.download();
    stage.draw(tiles, second, budget, sample, points, cuts, visibility, 1, true, sums);
    drawn = stage.drawn(second);
    estimates = sums.sums.download();
}

std::size_t Run::item(const Pass& pass, std::size_t pixel) {
    const std::size_t place = pixel / 16;
    return 16 * (16 * (place / pass.count) + pixel % 16) +
           place_order[pass.first + place % pass.count];
}

std::vector<reference::DrawnPixel> group_of(const Run& run, const Viewers& view, std::size_t p,
                                            bool starts) {
    std::vector<reference::DrawnPixel> pixels;
    for (std::size_t lane = 0; lane < run.lanes; ++lane) {
        const std::size_t item = Run::item(run.second, p / run.lanes * run.lanes + lane);
        const std::size_t tile = item / (std::size_t{ADAPTIVE_TILE} * ADAPTIVE_TILE);
        const glm::uvec2 at = item_pixel(run.tiles, item);
        reference::DrawnPixel& pixel = pixels.emplace_back(reference::DrawnPixel{
            run.hit(item) ? &run.surfaces[item] : nullptr,
            view.of(item),
            starts
                ? reference::draw_starts(at.x, at.y, run.second, run.sample.index, run.sample.seed)
                : reference::Starts{0.5, 0.5},
            {}});
        for (uint slot = 0; slot < run.sizes[tile]; ++slot)
            pixel.visible.push_back(run.visible[run.place(tile, slot, item / 16 % 64)]);
    }
    return pixels;
}

}  // namespace manylight::adaptive_stages

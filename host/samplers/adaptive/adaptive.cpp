// SPDX-License-Identifier: MIT
#include "samplers/adaptive/adaptive.hpp"

#include <algorithm>
#include <cmath>

namespace manylight {
namespace {

constexpr unsigned wide_image = 640;  // pixels: tiles are small, one probe per node will do
constexpr uint most_samples = 64;     // on average, of one draw of all nodes
constexpr std::size_t budget_pixels = std::size_t{1} << 15;  // are enough to find the mean from
constexpr std::size_t many_packets = std::size_t{1} << 17;   // of one launch, few of them in use

// Shadow rays of the first look to each light: an eighth of what four pixel samples of all pixels
// take, or a quarter of a million. None where every light is a node of its own, and where so few
// would say little of a light.
uint look_rays(std::size_t lights, std::size_t pixels) {
    constexpr std::size_t fewest = 16;
    constexpr std::size_t most = 256;
    if (lights <= CUT_CAPACITY) return 0;
    const std::size_t rays = std::max<std::size_t>(2 * pixels, std::size_t{1} << 18) / lights;
    return rays < fewest ? 0 : static_cast<uint>(std::min(rays, most));
}

// Pixels with many samples are drawn several times.
uint rounds_for(uint light_samples) { return (light_samples + most_samples - 1) / most_samples; }

float samples_of_round(uint light_samples) {
    return static_cast<float>(light_samples) / static_cast<float>(rounds_for(light_samples));
}

std::size_t packets_per_pixel(uint light_samples) {
    return static_cast<std::size_t>(std::ceil(samples_of_round(light_samples) * MOST_DRAWS / 16));
}

}  // namespace

Adaptive::Adaptive(const SamplerContext& context)
    : cut_stage_(context.device, context.scene),
      visibility_stage_(context.device, context.scene),
      adaptive_stage_(context.device, context.scene,
                      packets_for(context.tiles, context.light_samples),
                      std::size_t{context.tiles} * CELLS_PER_TILE * most_places),
      cuts_(context.device, context.tiles),
      visibility_(context.device, context.scene.light_count, context.tiles,
                  std::min(context.tiles, most_in_work)),
      light_count_(context.scene.light_count),
      width_(context.width) {
    if (const uint rays = look_rays(light_count_, context.items()); rays > 0)
        seen_lights_stage_.emplace(context.device, context.scene, rays);
}

Footprint Adaptive::footprint(const SamplerLoad& load) {
    Footprint out;
    out.tile = Cuts::tile_bytes() + Visibility::tile_bytes(load.lights) +
               CELLS_PER_TILE * most_places * sizeof(Expectation);
    out.tile_buffer = out.tile;
    out.fixed =
        (load.lights > CUT_CAPACITY ? SeenLightsStage::bytes(load.lights) : 0) +
        packets_for(load.tiles, load.light_samples) * AdaptiveStage::packet_bytes() +
        std::min<std::size_t>(load.tiles, most_in_work) * Visibility::work_bytes(load.lights);
    return out;
}

std::vector<bool> Adaptive::find_seen_lights(uint seed) {
    if (!seen_lights_stage_) return {};
    return seen_lights_stage_->find(seen_lights_stage_->look(seed), seed);
}

void Adaptive::begin(const Tiles& tiles, const Buffer<Surface>& surfaces, uint seed,
                     const RayCount& /*progress*/) {
    const CutOptions options{CUT_CAPACITY, width_ >= wide_image ? 1u : PROBE_RAYS, seed};
    visibility_.counts.clear();
    cut_stage_.make(tiles, surfaces, options, cuts_);
    tiles_ = tiles;
    fresh_ = true;
    is_summed_ = false;
    drawn_pixels_ = 0;
    factor_ = 0;
}

bool Adaptive::draw(const Tiles& tiles, const PixelSample& sample, uint light_samples,
                    const Buffer<Surface>& surfaces, Estimates& estimates, const Sink& sink) {
    // The first pixels were drawn from next to no knowledge: they are drawn once more, afresh.
    const Pass trial = {0, 1, 0, 0, 0, 0};
    const std::vector<Pass> first_passes = {
        {1, 3, 0, 0, 0, 0}, {4, 4, 0, 0, 0, 0}, {8, 8, 0, 0, 0, 0}, {0, 1, 1, 0, 0, 0}};
    const std::vector<Pass> passes = {{0, 8, 0, 0, 0, 0}, {8, 8, 0, 0, 0, 0}};
    if (fresh_)
        pass_over(tiles, trial, sample, light_samples, surfaces, estimates,
                  [](const auto&, std::size_t) { return true; });
    for (const Pass& pass : fresh_ ? first_passes : passes)
        if (!pass_over(tiles, pass, sample, light_samples, surfaces, estimates, sink)) return false;
    fresh_ = false;
    return true;
}

void Adaptive::save(FrameState& state) {
    sum_up();
    state.put("cut_nodes", cuts_.nodes);
    state.put("cut_sizes", cuts_.sizes);
    state.put("cut_probes", cuts_.probes);
    state.put("visibility_counts", visibility_.counts);
    state.put("budget_factor", factor_);
    state.put("budget_exposure", exposure_);
}

void Adaptive::resume(const Tiles& tiles, const Buffer<Surface>& /*surfaces*/, uint /*seed*/,
                      const FrameState& state, const RayCount& /*progress*/) {
    state.restore("cut_nodes", cuts_.nodes);
    state.restore("cut_sizes", cuts_.sizes);
    state.restore("cut_probes", cuts_.probes);
    state.restore("visibility_counts", visibility_.counts);
    factor_ = state.get<float>("budget_factor");
    exposure_ = state.get<float>("budget_exposure");
    tiles_ = tiles;
    fresh_ = false;
    is_summed_ = false;
    drawn_pixels_ = 0;
}

TileKnowledge Adaptive::knowledge(uint tile) {
    sum_up();
    visibility_stage_.estimate(tile, 1, cuts_, visibility_);
    const float samples = samples_of_round(light_samples_);
    TileKnowledge out{{},
                      {},
                      {samples, factor_ * samples, exposure_},
                      rounds_for(light_samples_),
                      adaptive_stage_.lanes()};
    out.cut =
        cuts_.nodes.download(std::size_t{tile} * CUT_CAPACITY, cuts_.sizes.download(tile, 1)[0]);
    const std::size_t slots = Visibility::slots(light_count_);
    const std::vector<float> visible = visibility_.visible.download(0, slots * CELLS_PER_TILE);
    for (std::size_t slot = 0; slot < out.cut.size(); ++slot)
        for (std::size_t cell = 0; cell < CELLS_PER_TILE; ++cell)
            out.visible.push_back(visible[(cell / 16 * slots + slot) * 16 + cell % 16]);
    return out;
}

// Returns whether to go on.
bool Adaptive::pass_over(const Tiles& tiles, Pass pass, const PixelSample& sample,
                         uint light_samples, const Buffer<Surface>& surfaces, Estimates& estimates,
                         const Sink& sink) {
    sum_up();
    light_samples_ = light_samples;
    const uint rounds = rounds_for(light_samples);
    const float samples = samples_of_round(light_samples);
    pass.packets = static_cast<uint>(packets_per_pixel(light_samples));
    const std::size_t tile_packets = std::size_t{CELLS_PER_TILE} * pass.count * pass.packets;
    const uint tiles_at_once =
        static_cast<uint>(std::clamp<std::size_t>(many_packets / tile_packets, 1, most_in_work));
    const Budget budget{samples, factor_ * samples, exposure_};
    for (; pass.first_tile < tiles.count; pass.first_tile += tiles_at_once) {
        pass.tile_count = std::min(tiles_at_once, tiles.count - pass.first_tile);
        visibility_stage_.estimate(pass.first_tile, pass.tile_count, cuts_, visibility_);
        for (uint round = 0; round < rounds; ++round) {
            Pass part = pass;
            part.number += 2 * round;
            adaptive_stage_.draw(tiles, part, budget, sample, surfaces, cuts_, visibility_,
                                 1.f / static_cast<float>(rounds), round == 0, estimates);
            visibility_stage_.learn(part, adaptive_stage_.draws(), visibility_);
        }
        if (!sink(pass, pass_pixels(pass) * light_samples)) return false;
    }
    is_summed_ = false;
    drawn_pixels_ = std::size_t{tiles.count} * CELLS_PER_TILE * pass.count;
    return true;
}

// Brings what is known up to the last pass.
void Adaptive::sum_up() {
    if (is_summed_) return;
    visibility_stage_.sum(tiles_, cuts_, visibility_);
    if (drawn_pixels_ > 0) set_budget(adaptive_stage_.expectations(drawn_pixels_));
    is_summed_ = true;
}

// Packets of a launch at most: one tile's pass at least.
std::size_t Adaptive::packets_for(std::size_t tiles, uint light_samples) {
    const std::size_t tile =
        std::size_t{CELLS_PER_TILE} * most_places * packets_per_pixel(light_samples);
    return std::max(std::min(many_packets, tiles * tile), tile);
}

// Finds the factor for which these pixels would get one draw each on average.
void Adaptive::set_budget(const std::vector<Expectation>& pixels) {
    double luminance = 0;
    for (const Expectation& e : pixels) luminance += e.luminance;
    if (!(luminance > 0)) return;
    const double exposure = 0.5 * static_cast<double>(pixels.size()) / luminance;
    std::vector<double> deviations;
    const std::size_t step = pixels.size() / budget_pixels | 1;  // odd: of all cells
    for (std::size_t i = 0; i < pixels.size(); i += step) {
        const Expectation& e = pixels[i];
        if (e.variance > 0)
            deviations.push_back(
                exposure * std::sqrt(e.variance / (std::pow(exposure * e.luminance, 2) + 0.01)));
    }
    if (deviations.empty()) return;
    double low = 0;
    double high = 1;
    const auto mean_draws = [&](double factor) {
        double sum = 0;
        for (const double d : deviations)
            sum += std::clamp<double>(d * factor, FEWEST_DRAWS, MOST_DRAWS);
        return sum / static_cast<double>(deviations.size());
    };
    while (mean_draws(high) < 1 && high < 1e30) high *= 2;
    for (int i = 0; i < 20; ++i) {
        const double middle = (low + high) / 2;
        (mean_draws(middle) < 1 ? low : high) = middle;
    }
    factor_ = static_cast<float>(high);
    exposure_ = static_cast<float>(exposure);
}

Sampler sampler_adaptive() {
    return {
        .name = "adaptive",
        .summary = "by contribution and learned visibility, from a cut of the light tree per tile",
        .color = "#d62728",
        .tree = true,
        .large_batches = true,
        .tile_size = ADAPTIVE_TILE,
        .most_lights = std::size_t{1} << 22,  // draws have 23 bits for a node
        .footprint = Adaptive::footprint,
        .make = [](const SamplerContext& context) -> std::unique_ptr<LightSampler> {
            return std::make_unique<Adaptive>(context);
        }};
}

}  // namespace manylight

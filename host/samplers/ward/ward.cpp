// SPDX-License-Identifier: MIT
#include "samplers/ward/ward.hpp"

#include <algorithm>
#include <cmath>

#include "shared/ward.h"

namespace manylight {
namespace {

// What the lights of a slice may take: more of them would fall out of the processor's caches
// between kernels (glossy.glb: half the time of 8 MiB). And how many slots there are however many
// lights.
constexpr std::size_t slice_bytes = std::size_t{2} << 20;
constexpr std::size_t fewest_slots = 64;

// Bytes of a light at a slot: its contribution and its place in the order.
constexpr std::size_t entry_bytes = sizeof(float4) + 2 * sizeof(uint);

std::size_t slots_for(std::size_t items, std::size_t lights) {
    const std::size_t fit = slice_bytes / (entry_bytes * lights);
    return std::min(items, std::max(fit, fewest_slots));
}

std::size_t slot_bytes(std::size_t lights) {
    return lights * entry_bytes + sizeof(float4) + 4 * sizeof(uint) +
           STEP_PACKETS * ShadowStage::packet_bytes();
}

}  // namespace

Ward::Ward(const SamplerContext& context)
    : scene_(context.scene.arguments),
      light_count_(context.scene.light_count),
      slots_(slots_for(context.items(), light_count_)),
      tau_(context.parameter("tau")),
      certainty_(context.parameter("certainty")),
      shadows_(context.device, context.scene, slots_ * STEP_PACKETS),
      probe_(context.device.kernel("samplers/ward/histories.cl", "ward_probe",
                                   context.scene.shading, "histories")),
      histories_(context.device.allocate<uint>(std::size_t{context.tiles} * light_count_)),
      contributions_(context.device.allocate<float4>(slots_ * light_count_)),
      order_(context.device.allocate<uint>(2 * slots_ * light_count_)),
      walks_(context.device.allocate<float4>(slots_)),
      counts_(context.device.allocate<uint>(4 * slots_)) {
    const auto kernel = [&](const char* name) {
        return context.device.kernel("samplers/ward/ward.cl", name, context.scene.shading,
                                     "samples");
    };
    weigh_ = kernel("ward_weigh");
    step_ = kernel("ward_step");
    tail_ = kernel("ward_tail");
}

std::size_t Ward::slots_of(const SamplerLoad& load) {
    return slots_for(load.tiles * load.tile_items(), load.lights);
}

Footprint Ward::footprint(const SamplerLoad& load) {
    Footprint out;
    out.fixed = slots_of(load) * slot_bytes(load.lights);
    out.tile = load.lights * sizeof(uint);
    out.tile_buffer = out.tile;
    return out;
}

double Ward::expected_begin_rays(const Tiles& tiles) const {
    return 0.5 * WARD_PROBES * tiles.count * light_count_;
}

void Ward::begin(const Tiles& tiles, const Buffer<Surface>& surfaces, uint seed,
                 const RayCount& progress) {
    tiles_ = tiles;
    probe_.launch(std::size_t{tiles.count} * light_count_, Arguments(scene_)
                                                               .set("tiles", tiles)
                                                               .set("surfaces", surfaces)
                                                               .set("seed", seed)
                                                               .set("histories", histories_));
    progress(begin_rays());
}

std::size_t Ward::begin_rays() const {
    std::size_t rays = 0;
    for (const uint history : histories()) rays += history & 0xffff;
    return rays;
}

std::vector<uint> Ward::histories() const {
    return histories_.download(0, std::size_t{tiles_.count} * light_count_);
}

void Ward::save(FrameState& state) { state.put("histories", std::span<const uint>(histories())); }

void Ward::resume(const Tiles& tiles, const Buffer<Surface>& /*surfaces*/, uint /*seed*/,
                  const FrameState& state, const RayCount& /*progress*/) {
    tiles_ = tiles;
    histories_.upload(state.get<uint>("histories", std::size_t{tiles_.count} * light_count_));
}

bool Ward::draw(const Tiles& tiles, const PixelSample& sample, uint light_samples,
                const Buffer<Surface>& surfaces, Estimates& estimates, const Sink& sink) {
    Arguments arguments = scene_;
    arguments.set(shadows_.buffers())
        .set("tiles", tiles)
        .set("surfaces", surfaces)
        .set("pixel_sample", sample.index)
        .set("seed", sample.seed)
        .set("tau", static_cast<float>(tau_))
        .set("look_ahead", static_cast<uint>(std::lround(std::pow(light_count_, certainty_))))
        .set("histories", histories_)
        .set("contributions", contributions_)
        .set("order", order_)
        .set("walks", walks_)
        .set("counts", counts_)
        .set("estimates", estimates.sums)
        .set("residuals", estimates.residuals);
    const std::size_t items = item_count(tiles);
    for (std::size_t first = 0; first < items; first += slots_) {
        const std::size_t slots = std::min(slots_, items - first);
        arguments.set("first_item", static_cast<uint>(first))
            .set("slots", static_cast<uint>(slots));
        walk(slots, sample, arguments);
        draw_tail(slots, sample, light_samples, arguments);
        const bool goes_on = sink({}, slots * light_samples);
        if (!goes_on && first + slots < items) return false;
    }
    return true;
}

// Tests lights, some of each slot at a time, until no slot wants more.
void Ward::walk(std::size_t slots, const PixelSample& sample, const Arguments& arguments) {
    weigh_.launch(slots, arguments);
    while (true) {
        step_.launch(slots, arguments);
        const std::vector<uint> counts = counts_.download(0, 4 * slots);
        bool goes_on = false;
        for (std::size_t i = 3; i < counts.size(); i += 4) goes_on = goes_on || counts[i] > 0;
        if (!goes_on) break;
        shadows_.trace(slots * STEP_PACKETS, sample.salt());
    }
    tail_.launch(slots, arguments);
}

// Radiance's defaults of these are 0.05 and 0.5 (-dt, -dc); with a certainty of 1 the rest has a
// bound.
std::vector<Parameter> ward_parameters() {
    return {{"tau", 0.05, 0, 1, "what the rest may be, relative to what was seen before it"},
            {"certainty", 1, 0, 1,
             "how far the rest is looked at: lights to this power (0: the next; 1: all)"}};
}

Sampler sampler_ward() {
    return {.name = "ward",
            .summary = "brightest lights first, until the rest matters little; that is guessed",
            .color = "#0b6e4f",
            .biased = true,
            .own_rays = true,
            .most_lights = most_ward_lights,
            .parameters = ward_parameters(),
            .footprint = Ward::footprint,
            .make = [](const SamplerContext& context) -> std::unique_ptr<LightSampler> {
                return std::make_unique<Ward>(context);
            }};
}

}  // namespace manylight

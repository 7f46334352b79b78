// SPDX-License-Identifier: MIT
#include "pipeline/schedule.hpp"

#include <algorithm>

#include "samplers/table.hpp"

namespace manylight {
namespace {

// Pixel samples of the whole image before its error may stop it: an image of few pixels says little
// of its error, and the stop would favour images that have missed something.
constexpr std::size_t fewest_samples = std::size_t{1} << 14;

uint whole_rounds(uint samples) {
    return (samples + ERROR_GROUPS - 1) / ERROR_GROUPS * ERROR_GROUPS;
}

}  // namespace

Schedule::Schedule(const RenderOptions& options, const Plan& plan, std::size_t lights)
    : options_(options),
      all_(all_tiles(options.width, options.height, options.tile_size())),
      batches_(plan.batches),
      tiles_per_batch_(plan.tiles_per_batch),
      lights_(static_cast<uint>(lights)),
      sampler_(find_sampler(options.sampler)) {}

uint Schedule::light_samples(uint i) const {
    if (sampler_.all_lights || lights_ == 0) return lights_;
    return options_.samples_of(sampler_.own_rays ? 0 : i);
}

float Schedule::weight(uint i) const {
    return static_cast<float>(std::max(light_samples(i), 1u)) /
           static_cast<float>(std::max(light_samples(0), 1u));
}

PixelSample Schedule::sample(uint i) const { return {i, options_.seed, options_.jitters()}; }

PixelSample Schedule::position(uint i) const {
    const PixelSample sample = this->sample(i);
    if (!options_.estimates_error()) return sample;
    const uint other = sample.index % 2 == 1 ? 0x9e3779b9u : 0u;
    return {sample.index / 2, sample.seed + other, sample.jitter};
}

Round Schedule::first_round(uint resumed_end) const {
    if (!(options_.target_error > 0)) return {options_.spp};
    const std::size_t pixels = std::size_t{options_.width} * options_.height;
    const uint fewest = whole_rounds(static_cast<uint>((fewest_samples + pixels - 1) / pixels));
    // Its share of all work is not known yet.
    return {std::min(std::max(fewest, resumed_end), options_.spp), 0, 0.2};
}

std::optional<Round> Schedule::next_round(const Round& round,
                                          const std::optional<ErrorEstimate>& error) const {
    const bool reached = error && error->most() <= options_.target_error;
    const bool late = options_.deadline && Clock::now() >= *options_.deadline;
    if (reached || round.end >= options_.spp || late || lights_ == 0) return {};
    double so_far = 0;  // weight of all samples
    for (uint i = 0; i < round.end; ++i) so_far += weight(i);
    // Errors fall as the inverse of the weight.
    const double most = 4 * so_far;
    const double needed = error ? so_far * 1.02 * error->most() / options_.target_error : most;
    const double next = std::min(needed, most);
    double then = so_far;
    uint end = round.end;
    do then += weight(end++);
    while ((then < next || end % ERROR_GROUPS != 0) && end < options_.spp);
    return Round{end, so_far / needed, (then - so_far) / needed};
}

Visit Schedule::visit(const Round& round, unsigned batch, uint done, double shown) const {
    Visit visit{batch, all_, done, round.end, Clock::now(), {}, shown, 0};
    visit.batch.first = batch * tiles_per_batch_;
    visit.batch.count = std::min(tiles_per_batch_, all_.count - visit.batch.first);
    if (options_.deadline)
        visit.deadline = visit.begun + (*options_.deadline - visit.begun) / (batches_ - batch);
    visit.share = round.share * visit.batch.count / all_.count;
    return visit;
}

double Schedule::progress(const Visit& visit, double begin_rays, double rays) const {
    double done = 0;
    if (visit.deadline) {
        done = seconds_since(visit.begun) /
               std::chrono::duration<double>(*visit.deadline - visit.begun).count();
    } else {
        double samples = 0;
        for (uint i = visit.first; i < visit.end; ++i) samples += std::max(light_samples(i), 1u);
        done = rays / (begin_rays + samples * static_cast<double>(item_count(visit.batch)));
    }
    return visit.shown + visit.share * std::clamp(done, 0.0, 1.0);
}

bool Pace::has_time(uint i, uint light_samples) const {
    if (!may_stop(i)) return true;
    const double expected = by_passes_ ? 0 : seconds_ * light_samples;
    return seconds_left() >= expected / 2;
}

bool Pace::goes_on(uint i) const { return !by_passes_ || !may_stop(i) || seconds_left() > 0; }

void Pace::end(uint light_samples) {
    seconds_ = seconds_since(begun_) / std::max(light_samples, 1u);
}

double Pace::seconds_left() const {
    return std::chrono::duration<double>(*deadline_ - Clock::now()).count();
}

}  // namespace manylight

// SPDX-License-Identifier: MIT
#include "pipeline/frame.hpp"

#include <algorithm>
#include <optional>

#include "clock.hpp"
#include "pipeline/adaptive.hpp"
#include "pipeline/aov.hpp"
#include "stages/accumulate.hpp"
#include "stages/reflections.hpp"
#include "stages/samples.hpp"

namespace manylight {
namespace {

// Adds the time until its end to a total, compiling apart.
class Stopwatch {
  public:
    Stopwatch(double& total, const Device& device)
        : total_(total), device_(device), compiled_(device.compile_seconds()) {}
    ~Stopwatch() { total_ += seconds_since(start_) - (device_.compile_seconds() - compiled_); }

  private:
    double& total_;
    const Device& device_;
    double compiled_;
    Clock::time_point start_ = Clock::now();
};

}  // namespace

struct Frame::Stages {
    DeviceScene scene;
    GBufferStage gbuffer;
    std::optional<SampleStage> samples;  // either of these two
    std::optional<Adaptive> adaptive;
    std::optional<ReflectionStage> reflections;
    AccumulateStage accumulate;
    std::optional<Clustering> clustering;
    Arguments tables;          // what the sampler draws from
    Buffer<Surface> centres;   // of the pixels, where the plan says so
    Buffer<Surface> surfaces;  // of the pixel samples
    Estimates estimates;
    ImageSum image;

    Stages(Device& device, DeviceScene uploaded)
        : scene(std::move(uploaded)), gbuffer(device, scene), accumulate(device, scene) {}
};

Frame::Frame(const Device& device, const Scene& scene, const WideBvh& bvh, const Camera& camera,
             const RenderOptions& options)
    : device_(device),
      scene_(scene),
      bvh_(bvh),
      camera_(camera),
      options_(options),
      sampler_(find_sampler(options.sampler)),
      plan_(make_plan(device.info(), scene, bvh, options)) {
    options_.clusters.shadow.weighed = sampler_.weighs_shadow;
    const auto lights = static_cast<uint>(scene.lights.size());
    light_samples_ = sampler_.all_lights || lights == 0 ? lights : options.light_samples;
    result_.light_samples = light_samples_;
}

Buffer<float4> Frame::allocate_zeros(std::size_t count) {
    Buffer<float4> buffer = device_.allocate<float4>(count);
    buffer.clear();
    return buffer;
}

void Frame::prepare() {
    const std::size_t pixels = std::size_t{options_.width} * options_.height;
    const std::size_t items =
        std::size_t{plan_.tiles_per_batch} * options_.tile_size() * options_.tile_size();
    const bool tree = sampler_.uses_tree();
    if (tree) {
        Stopwatch watch(result_.prepare_seconds, device_);
        tree_ = build_light_tree(scene_.lights);
    }
    DeviceScene uploaded = upload_scene(device_, scene_, bvh_, camera_, tree ? &tree_ : nullptr);
    if (options_.hide_emitters) uploaded.emission["HAS_EMISSION"] = 0;
    if (!options_.reflections) uploaded.shading["HAS_REFLECTIONS"] = 0;
    stages_ = std::make_shared<Stages>(device_, uploaded);
    Stages& s = *stages_;
    if (sampler_.table == Table::cuts)
        s.adaptive.emplace(device_, s.scene, plan_.tiles_per_batch, options_.width,
                           std::max(light_samples_, 1u));
    else
        s.samples.emplace(device_, s.scene, sampler_.kernel_file, items);
    if (uploaded.reflections && options_.reflections) s.reflections.emplace(device_, s.scene);
    s.surfaces = device_.allocate<Surface>(items);
    if (plan_.centres)
        s.centres = options_.jitters() ? device_.allocate<Surface>(items) : s.surfaces;
    s.estimates = {allocate_zeros(items), allocate_zeros(items)};
    s.image = {allocate_zeros(pixels), allocate_zeros(pixels)};
    if (plan_.clusters) {
        s.clustering.emplace(device_, s.scene, options_.clusters, plan_.tiles_per_batch);
        s.tables = s.clustering->tables();
    } else if (sampler_.table == Table::power && light_samples_ > 0) {
        Stopwatch watch(result_.prepare_seconds, device_);
        const Mixture mixture = mixture_of(sampler_, scene_.lights);
        s.tables.set("power_cdf", PdfStage(device_, s.scene).of_powers(mixture));
        device_.finish();
    }
}

FrameResult Frame::render(Progress& progress) {
    for (const Aov& aov : all_aovs())
        if (std::ranges::count(options_.aovs, aov.name))
            result_.aovs.emplace_back(aov.name,
                                      Image(options_.width, options_.height, aov.channels));
    Tiles batch = all_tiles(options_.width, options_.height, options_.tile_size());
    const uint tiles = batch.count;
    for (; batch.first < tiles; batch.first += plan_.tiles_per_batch) {
        batch.count = std::min(plan_.tiles_per_batch, tiles - batch.first);
        if (plan_.centres) {
            Stopwatch watch(result_.prepare_seconds, device_);
            stages_->gbuffer.trace(batch, {}, stages_->centres);
            if (options_.jitters()) result_.primary_rays += pixel_count(batch);
            if (plan_.clusters) cluster(batch, progress);
            keep_aovs(batch);
            device_.finish();
        }
        Stopwatch watch(result_.render_seconds, device_);
        sample(batch, progress);
    }
    Stopwatch watch(result_.render_seconds, device_);
    keep_image();
    return std::move(result_);
}

// How many rays clusters take shows only as they are made: half of the worst is taken for all.
double Frame::cluster_work(const Tiles& batch) const {
    if (!plan_.clusters) return 0;
    return 0.5 * batch.count * most_regions(options_.clusters) *
           static_cast<double>(scene_.lights.size());
}

// `work`: rays of the batch done so far, clusters first.
void Frame::report(Progress& progress, const Tiles& batch, double work) const {
    const Tiles all = all_tiles(options_.width, options_.height, options_.tile_size());
    const double samples =
        static_cast<double>(item_count(batch)) * options_.spp * std::max(light_samples_, 1u);
    const double share = work / (cluster_work(batch) + samples);
    progress.set((batch.first + batch.count * share) / all.count);
}

void Frame::cluster(const Tiles& batch, Progress& progress) {
    Clustering& clustering = *stages_->clustering;
    double done = 0;
    clustering.build(batch, stages_->centres, [&](std::size_t entries) {
        device_.finish();
        done += static_cast<double>(entries);
        report(progress, batch, std::min(done, cluster_work(batch)));
    });
    clustering.normalise(mixture_of(sampler_, scene_.lights));
    for (const RowSum& total : clustering.totals()) result_.shadow_rays += total.facing_count;
    clusters_before_ = result_.clusters;
    for (const uint split : clustering.split()) result_.clusters += split == 0;
}

void Frame::keep_aovs(const Tiles& batch) {
    if (result_.aovs.empty()) return;
    BatchFacts facts;
    facts.scene = &scene_;
    facts.surfaces = stages_->centres.download(0, item_count(batch));
    if (plan_.clusters) {
        facts.rows = stages_->clustering->item_rows();
        facts.representatives = stages_->clustering->representatives();
        facts.totals = stages_->clustering->totals();
        std::size_t number = clusters_before_;
        for (const uint split : stages_->clustering->split()) {
            facts.numbers.push_back(number);
            number += split == 0;
        }
    }
    for (auto& [name, layer] : result_.aovs)
        fill_layer(*std::ranges::find(all_aovs(), name, &Aov::name), facts, batch, layer);
}

void Frame::sample(const Tiles& batch, Progress& progress) {
    Stages& s = *stages_;
    double done = cluster_work(batch);
    for (uint i = 0; i < options_.spp; ++i) {
        const PixelSample sample{i, options_.seed, options_.jitters()};
        const bool at_hand = !options_.jitters() && (i > 0 || plan_.centres);
        if (!at_hand) s.gbuffer.trace(batch, sample, s.surfaces);
        if (!at_hand || i == 0) result_.primary_rays += pixel_count(batch);
        const auto count = [&](std::size_t samples) {
            device_.finish();
            done += static_cast<double>(samples);
            report(progress, batch, done);
        };
        if (s.adaptive && light_samples_ > 0) {
            if (i == 0) s.adaptive->start(batch, s.surfaces, options_.seed);
            s.adaptive->draw(batch, sample, s.surfaces, s.estimates, count);
        } else if (s.samples) {
            s.samples->draw(batch, sample, light_samples_, s.surfaces, s.tables, s.estimates,
                            count);
        }
        if (s.reflections) s.reflections->add(batch, sample, s.surfaces, s.estimates.sums);
        s.accumulate.add(batch, s.surfaces, s.estimates.sums, s.image);
    }
    device_.finish();
}

void Frame::keep_image() {
    result_.image = Image(options_.width, options_.height, {"R", "G", "B"});
    const std::vector<float4> sums = stages_->image.sums.download();
    double rays = 0;
    for (std::size_t i = 0; i < sums.size(); ++i) {
        for (int c = 0; c < 3; ++c)
            result_.image.values[3 * i + c] = sums[i][c] / static_cast<float>(options_.spp);
        rays += sums[i].w;
    }
    result_.shadow_rays += static_cast<std::size_t>(rays);
}

}  // namespace manylight

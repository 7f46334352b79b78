// SPDX-License-Identifier: MIT
#include "pipeline/frame.hpp"

#include <algorithm>
#include <limits>
#include <optional>

#include "clock.hpp"
#include "device/kernel_sources.hpp"
#include "output/hash.hpp"
#include "pipeline/aov.hpp"
#include "pipeline/image_options.hpp"
#include "stages/accumulate.hpp"
#include "stages/reflections.hpp"

namespace manylight {
namespace {

// Pixel samples of the whole image before its error may stop it: an image of few pixels says little
// of its error, and the stop would favour images that have missed something.
constexpr std::size_t fewest_samples = std::size_t{1} << 14;

// Whether a ray may find another surface than the same ray of another sample.
bool passes_by_chance(const Scene& scene) {
    return std::ranges::any_of(scene.alpha_triangles,
                               [](const AlphaTriangle& t) { return t.second.z < 0; });
}

uint whole_rounds(uint samples) {
    return (samples + ERROR_GROUPS - 1) / ERROR_GROUPS * ERROR_GROUPS;
}

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
    std::unique_ptr<LightSampler> sampler;
    std::optional<ReflectionStage> reflections;
    AccumulateStage accumulate;
    Buffer<Surface> centres;        // of the pixels, where the plan says so
    std::size_t centres_first = 0;  // of their points (see GBufferStage)
    Buffer<Surface> surfaces;       // of the pixel samples
    Estimates estimates;
    ImageSum image;

    Stages(Device& device, DeviceScene uploaded, std::size_t pixels, bool grouped)
        : scene(std::move(uploaded)),
          gbuffer(device, scene),
          accumulate(device, scene, grouped),
          image(device, pixels, grouped) {}
};

Frame::Frame(const Device& device, const Scene& scene, const WideBvh& bvh, const Camera& camera,
             const RenderOptions& options)
    : device_(device),
      scene_(scene),
      bvh_(bvh),
      camera_(camera),
      options_(options),
      sampler_(find_sampler(options.sampler)),
      plan_(make_plan(device.info(), scene, bvh, options)) {}

// Light samples of pixel sample i.
uint Frame::samples_of(uint i) const {
    const auto lights = static_cast<uint>(scene_.lights.size());
    return sampler_.all_lights || lights == 0 ? lights : options_.samples_of(i);
}

// Pixel samples count by their light samples, and alike where there are no lights.
float Frame::weight_of(uint i) const {
    return static_cast<float>(std::max(samples_of(i), 1u)) /
           static_cast<float>(std::max(samples_of(0), 1u));
}

// Positions in the pixel, and reflections, are stratified over samples. What the error is estimated
// from has to be independent: the even and the odd samples then have such a sequence each.
PixelSample Frame::position_of(PixelSample sample) const {
    if (!options_.estimates_error()) return sample;
    const uint other = sample.index % 2 == 1 ? 0x9e3779b9u : 0u;
    return {sample.index / 2, sample.seed + other, sample.jitter};
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
    const bool tree = sampler_.tree;
    if (tree) {
        Stopwatch watch(result_.prepare_seconds, device_);
        tree_ = build_light_tree(scene_.lights);
    }
    const bool two_surfaces = plan_.centres && options_.jitters();
    DeviceScene uploaded = upload_scene(device_, scene_, bvh_, camera_, tree ? &tree_ : nullptr,
                                        two_surfaces ? 2 * items : items);
    if (options_.hide_emitters) uploaded.emission["HAS_EMISSION"] = 0;
    if (!options_.reflections) uploaded.shading["HAS_REFLECTIONS"] = 0;
    stages_ = std::make_shared<Stages>(device_, uploaded, pixels, options_.estimates_error());
    Stages& s = *stages_;
    s.sampler = sampler_.make({device_, s.scene, scene_.lights, plan_.tiles_per_batch,
                               options_.tile_size(), options_.width, options_.most_samples(),
                               options_.clusters, values_of(sampler_, options_.parameters)});
    if (uploaded.shading.at("HAS_REFLECTIONS") != 0) s.reflections.emplace(device_, s.scene);
    s.surfaces = device_.allocate<Surface>(items);
    if (plan_.centres) s.centres = two_surfaces ? device_.allocate<Surface>(items) : s.surfaces;
    s.centres_first = two_surfaces ? items : 0;
    s.estimates = {allocate_zeros(items), allocate_zeros(items)};
    device_.compile();
    if (scene_.lights.empty()) return;
    Stopwatch watch(result_.prepare_seconds, device_);
    s.sampler->prepare();
    device_.finish();
}

FrameResult Frame::render(Progress& progress, const Saving& saving, const FrameState* state) {
    saving_ = saving;
    saved_ = Clock::now();
    for (const Aov& aov : all_aovs())
        if (std::ranges::count(options_.aovs, aov.name))
            result_.aovs.emplace_back(aov.name,
                                      Image(options_.width, options_.height, aov.channels));
    done_.assign(plan_.batches, 0);
    layers_kept_.assign(plan_.batches, false);
    if (state != nullptr) resume(*state);
    if (options_.target_error > 0)
        render_to_error(progress);
    else
        visit_all(options_.spp, 0, 1, progress);
    if (std::ranges::any_of(done_, [&](uint samples) { return samples != done_[0]; }))
        result_.is_cut_short = true;
    if (options_.target_error > 0) return std::move(result_);
    if (options_.estimates_error()) {
        keep_estimate();
    } else {
        Stopwatch watch(result_.render_seconds, device_);
        keep_image();
    }
    return std::move(result_);
}

// Renders as many samples as the error so far says are needed, and looks again.
void Frame::render_to_error(Progress& progress) {
    const std::size_t pixels = std::size_t{options_.width} * options_.height;
    const uint fewest = whole_rounds(static_cast<uint>((fewest_samples + pixels - 1) / pixels));
    uint end = std::min(std::max(fewest, resumed_end_), options_.spp);
    double shown = 0;
    double share = 0.2;  // of all work, which is not known yet
    double weight = 0;   // of all samples until `end`
    uint counted = 0;
    while (true) {
        visit_all(end, shown, share, progress);
        keep_estimate();
        const std::optional<ErrorEstimate>& error = result_.error;
        const bool late = options_.deadline && Clock::now() >= *options_.deadline;
        if (result_.is_cut_short && is_interrupted()) return;
        const bool reached = error && error->most() <= options_.target_error;
        if (reached || end >= options_.spp || late || scene_.lights.empty()) {
            if (saving_.save && end < options_.spp) save(plan_.batches - 1, end);
            return;
        }
        for (; counted < end; ++counted) weight += weight_of(counted);
        // Errors fall as the inverse of the weight.
        const double most = 4 * weight;
        const double needed = error ? weight * 1.02 * error->most() / options_.target_error : most;
        const double next = std::min(needed, most);
        double weight_then = weight;
        do weight_then += weight_of(end++);
        while ((weight_then < next || end % ERROR_GROUPS != 0) && end < options_.spp);
        shown = weight / needed;
        share = (weight_then - weight) / needed;
    }
}

// Brings all batches to `end` samples per pixel, or as far as time allows.
void Frame::visit_all(uint end, double shown, double share, Progress& progress) {
    const Tiles all = all_tiles(options_.width, options_.height, options_.tile_size());
    for (unsigned i = 0; i < plan_.batches; ++i) {
        if (is_interrupted()) {
            result_.is_cut_short = true;
            return;
        }
        Visit visit;
        visit.batch = all;
        visit.number = i;
        visit.end = end;
        visit.batch.first = i * plan_.tiles_per_batch;
        visit.batch.count = std::min(plan_.tiles_per_batch, all.count - visit.batch.first);
        visit.begun = Clock::now();
        if (options_.deadline)
            visit.deadline = visit.begun + (*options_.deadline - visit.begun) / (plan_.batches - i);
        visit.share = share * visit.batch.count / all.count;
        visit.shown = shown;
        shown += visit.share;
        // What is kept of a batch is lost where another one was in between.
        if (state_ != nullptr && state_->get<uint>("batch") == i) visit.state = state_;
        visit.fresh = done_[i] == 0 || plan_.batches > 1 || visit.state != nullptr;
        if (plan_.centres && visit.fresh) {
            Stopwatch watch(result_.prepare_seconds, device_);
            stages_->gbuffer.trace(visit.batch, {}, stages_->centres, stages_->centres_first);
            if (options_.jitters() && visit.state == nullptr)  // which has counted them
                result_.primary_rays += pixel_count(visit.batch);
            if (plan_.clusters) begin(visit, stages_->centres, progress);
            if (!layers_kept_[i]) keep_aovs(visit.batch);
            layers_kept_[i] = true;
            device_.finish();
        }
        Stopwatch watch(result_.render_seconds, device_);
        sample(visit, progress);
        if (visit.state != nullptr && plan_.batches > 1) state_ = nullptr;  // this batch was done
    }
}

// `work`: rays of the visit done so far, clusters first.
void Frame::report(Progress& progress, const Visit& visit, double work) const {
    double samples = 0;
    for (uint i = done_[visit.number]; i < visit.end && !visit.deadline; ++i)
        samples += std::max(samples_of(i), 1u);
    double done = work / (stages_->sampler->expected_begin_rays(visit.batch) +
                          samples * static_cast<double>(item_count(visit.batch)));
    if (visit.deadline)
        done = seconds_since(visit.begun) /
               std::chrono::duration<double>(*visit.deadline - visit.begun).count();
    progress.set(visit.shown + visit.share * std::clamp(done, 0.0, 1.0));
}

// What the sampler makes of a batch before it draws.
void Frame::begin(const Visit& visit, const Buffer<Surface>& surfaces, Progress& progress) {
    LightSampler& sampler = *stages_->sampler;
    double done = 0;
    const RayCount count = [&](std::size_t rays) {
        device_.finish();
        done += static_cast<double>(rays);
        report(progress, visit, std::min(done, stages_->sampler->expected_begin_rays(visit.batch)));
    };
    if (visit.state == nullptr) {
        sampler.begin(visit.batch, surfaces, options_.seed, count);
        begin_rays_ += sampler.begin_rays();
    } else {  // which has counted them
        sampler.resume(visit.batch, surfaces, options_.seed, *visit.state, count);
    }
    if (layers_kept_[visit.number]) return;
    clusters_before_ = result_.clusters;
    result_.clusters += sampler.cluster_count();
}

void Frame::keep_aovs(const Tiles& batch) {
    if (result_.aovs.empty()) return;
    BatchFacts facts;
    facts.origin = scene_.origin;
    facts.materials = stages_->scene.materials.download();
    facts.surfaces = stages_->centres.download(0, item_count(batch));
    if (plan_.clusters) {
        facts.clusters = stages_->sampler->cluster_facts();
        std::size_t number = clusters_before_;
        for (const uint split : facts.clusters.split) {
            facts.numbers.push_back(number);
            number += split == 0;
        }
    }
    for (auto& [name, layer] : result_.aovs) {
        const Aov& aov = *std::ranges::find(all_aovs(), name, &Aov::name);
        if (aov.fill) fill_layer(aov, facts, batch, layer);
    }
}

void Frame::sample(const Visit& visit, Progress& progress) {
    Stages& s = *stages_;
    const Tiles& batch = visit.batch;
    double work = s.sampler->expected_begin_rays(batch);
    double seconds_per_sample = 0;  // of a light sample of all pixels
    bool by_passes = false;         // the sampler finishes some pixels after others
    const uint first = done_[visit.number];
    for (uint i = first; i < visit.end; ++i) {
        if (is_interrupted()) {
            result_.is_cut_short = true;
            break;
        }
        const uint count = samples_of(i);
        const auto begun = Clock::now();
        const auto seconds_left = [&] {
            return std::chrono::duration<double>(*visit.deadline - Clock::now()).count();
        };
        // One sample is taken whatever the time.
        const bool may_stop = visit.deadline.has_value() && i > 0;
        const double expected = by_passes ? 0 : seconds_per_sample * count;
        if (may_stop && seconds_left() < expected / 2) {
            result_.is_cut_short = true;
            break;
        }
        const PixelSample sample{i, options_.seed, options_.jitters()};
        const bool alike = !options_.jitters() && !passes_by_chance(scene_);
        const bool at_hand = alike && (i > first || plan_.centres);
        if (!at_hand) s.gbuffer.trace(batch, position_of(sample), s.surfaces);
        if (!at_hand || i == 0) result_.primary_rays += pixel_count(batch);
        const auto add = [&](const std::optional<Pass>& pass) {
            s.accumulate.add(batch, pass, s.surfaces, s.estimates.sums,
                             {weight_of(i), i % ERROR_GROUPS}, s.image);
        };
        if (i == first && visit.fresh && !plan_.clusters && count > 0)
            begin(visit, s.surfaces, progress);
        by_passes = false;
        const Sink sink = [&](const std::optional<Pass>& finished, std::size_t samples) {
            if (finished && !s.reflections) add(finished);
            by_passes = finished.has_value();
            device_.finish();
            work += static_cast<double>(samples);
            report(progress, visit, work);
            if (is_interrupted() && !saving_.save) return false;  // a state is one between samples
            return !by_passes || !may_stop || seconds_left() > 0;
        };
        done_[visit.number] = i + 1;
        const bool complete =
            count == 0 || s.sampler->draw(batch, sample, count, s.surfaces, s.estimates, sink);
        if (!complete) {
            result_.is_cut_short = true;
            continue;
        }
        if (s.reflections)
            s.reflections->add(batch, position_of(sample), s.surfaces, s.estimates.sums);
        if (s.reflections || !by_passes) add({});
        device_.finish();
        seconds_per_sample = seconds_since(begun) / std::max(count, 1u);
        const bool is_last = i + 1 == options_.spp && visit.number + 1 == plan_.batches;
        state_ = nullptr;
        if (saving_.save &&
            (is_last || is_interrupted() || seconds_since(saved_) > saving_.seconds))
            save(visit.number, visit.end);
    }
}

std::string Frame::name() const {
    ContentHash hash;
    const RenderOptions& o = options_;
    hash.add(scene_).add(std::as_bytes(std::span(&camera_, 1)));
    for (const auto& [option, value] : image_options(o)) hash.add(option).add(value.dump());
    hash.add(o.jitters()).add(plan_.tiles_per_batch);
    hash.add(device_.info().name).add(device_.info().platform).add(device_.form().lanes);
    for (const auto& [file, text] : kernel_sources) hash.add(text);
    return std::string(o.sampler) + " " + hash.add(MANYLIGHT_VERSION).name();
}

bool Frame::is_interrupted() const { return options_.interrupted && options_.interrupted(); }

// Between two pixel samples of a batch that is on the way to `end` of them.
void Frame::save(unsigned batch, uint end) {
    FrameState state;
    Stages& s = *stages_;
    state.put("batch", uint{batch});
    state.put("end", end);
    state.put("spp", options_.planned_spp());
    state.put("done", std::span<const uint>(done_));
    state.put("begin_rays", std::uint64_t{begin_rays_});
    state.put("primary_rays", std::uint64_t{result_.primary_rays});
    state.put("sums", s.image.sums);
    state.put("residuals", s.image.residuals);
    state.put("weights", s.image.weights);
    if (options_.estimates_error()) state.put("groups", s.image.groups);
    if (!scene_.lights.empty()) s.sampler->save(state);
    saving_.save(state);
    saved_ = Clock::now();
}

void Frame::resume(const FrameState& state) {
    Stages& s = *stages_;
    const auto spp = state.get<uint>("spp");
    if (plan_.batches > 1) {  // of those that are done, nothing is kept to go on
        if (options_.spp > spp)
            throw InputError(
                "--spp {}: the checkpoint's image is made in {} batches, of {} pixel samples each: "
                "it can have fewer, not more",
                options_.spp, plan_.batches, spp);
        if (options_.spp < spp) saving_.save = nullptr;
    }
    state_ = &state;
    resumed_end_ = state.get<uint>("end");
    done_ = state.get<uint>("done", plan_.batches);
    begin_rays_ = state.get<std::uint64_t>("begin_rays");
    result_.primary_rays = state.get<std::uint64_t>("primary_rays");
    result_.is_resumed = true;
    state.restore("sums", s.image.sums);
    state.restore("residuals", s.image.residuals);
    state.restore("weights", s.image.weights);
    if (options_.estimates_error()) state.restore("groups", s.image.groups);
}

// The image so far, and what its groups of samples say of its error.
void Frame::keep_estimate() {
    Stopwatch watch(result_.render_seconds, device_);
    keep_image();
    result_.error =
        estimate_error(options_.width, options_.height, stages_->image.groups.download());
    for (auto& [name, layer] : result_.aovs) {
        if (name != "error") continue;
        if (result_.error)
            layer = result_.error->pixels;
        else
            std::ranges::fill(layer.values, std::numeric_limits<float>::quiet_NaN());
    }
}

LightSampler& Frame::sampler() const { return *stages_->sampler; }

void Frame::keep_image() {
    result_.image = Image(options_.width, options_.height, {"R", "G", "B"});
    const std::vector<float4> sums = stages_->image.sums.download();
    const std::vector<float> weights = stages_->image.weights.download();
    double rays = 0;
    double samples = 0;
    result_.empty_pixels = static_cast<std::size_t>(std::ranges::count(weights, 0.f));
    const auto first_weight = static_cast<float>(RenderOptions::first_samples);
    const float later_weight = weight_of(RenderOptions::first_samples);
    for (std::size_t i = 0; i < sums.size(); ++i) {
        for (int c = 0; c < 3; ++c)
            result_.image.values[3 * i + c] = sums[i][c] / std::max(weights[i], 1e-30f);
        rays += sums[i].w;
        samples += std::min(weights[i], first_weight) +
                   std::max(weights[i] - first_weight, 0.f) / later_weight;
    }
    result_.shadow_rays = begin_rays_ + static_cast<std::size_t>(rays);
    result_.spp = samples / static_cast<double>(sums.size());
    result_.light_samples = samples_of(0);
    result_.later_light_samples = samples_of(std::max(std::ranges::max(done_), 1u) - 1);
}

}  // namespace manylight

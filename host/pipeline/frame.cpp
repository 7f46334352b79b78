// SPDX-License-Identifier: MIT
#include "pipeline/frame.hpp"

#include <algorithm>

#include "stages/reflections.hpp"

namespace manylight {
namespace {

// Whether a ray may find another surface than the same ray of another sample.
bool passes_by_chance(const Scene& scene) {
    return std::ranges::any_of(scene.alpha_triangles,
                               [](const AlphaTriangle& t) { return t.second.z < 0; });
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

Buffer<float4> allocate_zeros(Device& device, std::size_t count) {
    Buffer<float4> buffer = device.allocate<float4>(count);
    buffer.clear();
    return buffer;
}

}  // namespace

struct Frame::Stages {
    DeviceScene scene;
    GBufferStage gbuffer;
    std::unique_ptr<LightSampler> sampler;
    std::optional<ReflectionStage> reflections;
    std::optional<EmitterPartStage> emitter_parts;
    AccumulateStage accumulate;
    Buffer<Surface> centres;        // of the pixels, where the plan says so
    std::size_t centres_first = 0;  // of their points (see GBufferStage)
    Buffer<Surface> surfaces;       // of the pixel samples
    Estimates estimates;
    Buffer<float4> seen;  // of emitters' parts, in the pixel samples
    ImageSum image;

    Stages(Device& device, DeviceScene uploaded, std::size_t pixels, bool grouped)
        : scene(std::move(uploaded)),
          gbuffer(device, scene),
          accumulate(device, scene, grouped),
          image(device, pixels, grouped) {}
};

// A visit of a batch.
struct Frame::Work {
    Visit visit;
    const FrameState* state;  // that the batch goes on with
    bool fresh;               // nothing is kept of it
    Pace pace;
    double begin_rays;         // that its beginning takes, about
    double rays = begin_rays;  // that are done
};

Frame::Frame(const Device& device, const Scene& scene, const WideBvh& bvh, const Camera& camera,
             const RenderOptions& options)
    : device_(device),
      scene_(scene),
      bvh_(bvh),
      camera_(camera),
      options_(options),
      sampler_(find_sampler(options.sampler)),
      emitter_parts_(options.emitter_parts(scene, camera)),
      plan_(make_plan(device.info(), scene, bvh, options, emitter_parts_)),
      memory_(plan_, options.sampler),
      schedule_(options_, plan_, scene.lights.size()),
      checkpoints_(options_, plan_),
      layers_(scene, options_, plan_) {}

void Frame::prepare() {
    DeviceScene uploaded = upload();
    {
        const Counting counting(device_, memory_.image.use);
        stages_ = std::make_shared<Stages>(device_, std::move(uploaded),
                                           std::size_t{options_.width} * options_.height,
                                           options_.estimates_error());
        if (!emitter_parts_.empty())
            stages_->emitter_parts.emplace(device_, stages_->scene, emitter_parts_);
    }
    Stages& s = *stages_;
    allocate_pixels();
    if (!scene_.lights.empty()) make_sampler();
    device_.compile();
    if (!s.sampler) return;
    Stopwatch watch(result_.prepare_seconds, device_);
    if (sampler_.tree) make_tree();
    const Counting counting(device_, memory_.sampler.use);
    s.sampler->prepare();
    device_.finish();
}

void Frame::make_tree() {
    std::vector<bool> seen;
    {
        const Counting counting(device_, memory_.sampler.use);
        seen = stages_->sampler->find_seen_lights(options_.seed);
    }
    tree_ = build_light_tree(scene_.lights, seen);
    fill_tree(tree_, stages_->scene);
}

// Items of a batch.
std::size_t Frame::items() const {
    return std::size_t{plan_.tiles_per_batch} * options_.tile_size() * options_.tile_size();
}

DeviceScene Frame::upload() {
    const Counting counting(device_, memory_.scene.use);
    DeviceScene uploaded = upload_scene(device_, scene_, bvh_, camera_, nullptr,
                                        has_two_surfaces() ? 2 * items() : items());
    if (sampler_.tree && !scene_.lights.empty()) reserve_tree(device_, scene_.lights, uploaded);
    if (options_.hide_emitters) uploaded.emission["HAS_EMISSION"] = 0;
    if (!emitter_parts_.empty()) uploaded.emission["HAS_EMITTER_PARTS"] = 1;
    if (!options_.reflections) uploaded.shading["HAS_REFLECTIONS"] = 0;
    return uploaded;
}

void Frame::allocate_pixels() {
    const Counting counting(device_, memory_.pixels.use);
    Stages& s = *stages_;
    s.surfaces = device_.allocate<Surface>(items());
    if (plan_.centres)
        s.centres = has_two_surfaces() ? device_.allocate<Surface>(items()) : s.surfaces;
    s.centres_first = has_two_surfaces() ? items() : 0;
    s.estimates = {allocate_zeros(device_, items()), allocate_zeros(device_, items())};
    if (s.emitter_parts) s.seen = device_.allocate<float4>(items());
    if (s.scene.shading.at("HAS_REFLECTIONS") != 0)
        s.reflections.emplace(device_, s.scene, items(), sampler_.closed_form);
}

void Frame::make_sampler() {
    const Counting counting(device_, memory_.sampler.use);
    stages_->sampler = sampler_.make({device_, stages_->scene, scene_.lights, plan_.tiles_per_batch,
                                      options_.tile_size(), options_.width, options_.most_samples(),
                                      options_.clusters, values_of(sampler_, options_.parameters)});
}

// Rounds over the image, until it is as it should be, or there is no more time.
FrameResult Frame::render(Progress& progress, const Saving& saving, const FrameState* state) {
    standing_.done.assign(plan_.batches, 0);
    checkpoints_.start(saving, state, standing_, stages_->image);
    Round round = schedule_.first_round(checkpoints_.resumed_end());
    while (true) {
        render_round(round, progress);
        keep_image();
        if (result_.is_cut_short && is_interrupted()) break;
        const std::optional<Round> next = schedule_.next_round(round, result_.error);
        if (!next) {
            if (has_drawn_ && checkpoints_.are_saved() && round.end < options_.spp)
                save(plan_.batches - 1, round.end);
            break;
        }
        round = *next;
    }
    if (std::ranges::count(standing_.done, standing_.done[0]) != plan_.batches)
        result_.is_cut_short = true;
    result_.is_resumed = checkpoints_.is_resumed();
    result_.primary_rays = standing_.primary_rays;
    result_.clusters = layers_.clusters();
    result_.aovs = layers_.take();
    return std::move(result_);
}

// A round brings one batch after another to as many samples per pixel, or as far as time allows.
void Frame::render_round(const Round& round, Progress& progress) {
    double shown = round.shown;
    for (unsigned i = 0; i < plan_.batches; ++i) {
        if (is_interrupted()) {
            result_.is_cut_short = true;
            return;
        }
        const Visit visit = schedule_.visit(round, i, standing_.done[i], shown);
        shown += visit.share;
        const FrameState* state = checkpoints_.state_of(i);
        // What is kept of a batch is lost where another one was in between.
        const bool fresh = standing_.done[i] == 0 || plan_.batches > 1 || state != nullptr;
        const LightSampler* sampler = stages_->sampler.get();
        Work work{visit, state, fresh, Pace(visit),
                  sampler != nullptr ? sampler->expected_begin_rays(visit.batch) : 0};
        if (plan_.centres && fresh) {
            Stopwatch watch(result_.prepare_seconds, device_);
            trace_centres(work, progress);
        }
        Stopwatch watch(result_.render_seconds, device_);
        take_samples(work, progress);
        if (state != nullptr && plan_.batches > 1) checkpoints_.drop_state();  // this batch is done
    }
}

// Whether the rays of a batch's beginning count: not again where a render goes on, or where a batch
// that was done is begun for its layers alone.
bool Frame::is_counted(const Work& work) {
    return work.state == nullptr && work.visit.first < work.visit.end;
}

// Stage gbuffer finds the surfaces at the pixels' centres; they are clustered, and their layers
// kept.
void Frame::trace_centres(const Work& work, Progress& progress) {
    Stages& s = *stages_;
    const Tiles& batch = work.visit.batch;
    s.gbuffer.trace(batch, {}, s.centres, s.centres_first);
    if (options_.jitters() && is_counted(work)) standing_.primary_rays += pixel_count(batch);
    if (plan_.clusters) begin_batch(work, s.centres, progress);
    layers_.keep(work.visit.number, batch, s.scene.materials, s.centres, s.sampler.get());
    device_.finish();
}

// Before it draws, the sampler makes of a batch what it needs: clusters, contributions and PDFs, or
// cuts.
void Frame::begin_batch(const Work& work, const Buffer<Surface>& surfaces, Progress& progress) {
    const Counting counting(device_, memory_.sampler.use);
    LightSampler& sampler = *stages_->sampler;
    double done = 0;
    const RayCount count = [&](std::size_t rays) {
        device_.finish();
        done += static_cast<double>(rays);
        progress.set(
            schedule_.progress(work.visit, work.begin_rays, std::min(done, work.begin_rays)));
    };
    if (work.state == nullptr) {
        sampler.begin(work.visit.batch, surfaces, options_.seed, count);
        if (is_counted(work)) standing_.begin_rays += sampler.begin_rays();
    } else {
        sampler.resume(work.visit.batch, surfaces, options_.seed, *work.state, count);
    }
}

// A pixel sample of every pixel of the batch goes through stages gbuffer, samples, reflections and
// accumulate, one after another as long as there is time.
void Frame::take_samples(Work& work, Progress& progress) {
    Stages& s = *stages_;
    const Visit& visit = work.visit;
    for (uint i = visit.first; i < visit.end; ++i) {
        const uint light_samples = schedule_.light_samples(i);
        if (is_interrupted() || !work.pace.has_time(i, light_samples)) {
            result_.is_cut_short = true;
            break;
        }
        work.pace.begin();
        const bool begins = i == visit.first && work.fresh && !plan_.clusters && light_samples > 0;
        if (begins && i > 0) {
            // With the first sample's surfaces: what is made of a batch is the same whenever.
            trace_surfaces(work, 0);
            begin_batch(work, s.surfaces, progress);
        }
        const bool traced = trace_surfaces(work, i);
        if (traced || i == 0) standing_.primary_rays += pixel_count(visit.batch);
        if (begins && i == 0) begin_batch(work, s.surfaces, progress);
        has_drawn_ = true;
        standing_.done[visit.number] = i + 1;
        if (!draw_lights(work, i, progress)) {
            result_.is_cut_short = true;
            continue;
        }
        if (s.reflections)
            s.reflections->add(visit.batch, schedule_.position(i), light_samples, s.surfaces,
                               s.sampler->tables(), s.estimates.sums);
        if (s.reflections || !work.pace.by_passes()) accumulate(work, i, {});
        device_.finish();
        work.pace.end(light_samples);
        checkpoints_.drop_state();
        const bool is_last = i + 1 == options_.spp && visit.number + 1 == plan_.batches;
        if (checkpoints_.are_saved() && (is_last || is_interrupted() || checkpoints_.is_due()))
            save(visit.number, visit.end);
    }
}

// Stage gbuffer finds the surfaces of pixel sample i, unless they are at hand, and stage
// emitter_parts what is seen of their parts. Returns whether the first traced.
bool Frame::trace_surfaces(const Work& work, uint i) {
    Stages& s = *stages_;
    const bool alike = !options_.jitters() && !passes_by_chance(scene_);
    const bool at_hand = alike && (i > work.visit.first || plan_.centres);
    if (!at_hand) s.gbuffer.trace(work.visit.batch, schedule_.position(i), s.surfaces);
    if (s.emitter_parts)
        s.emitter_parts->trace(work.visit.batch, schedule_.position(i), s.surfaces, s.seen);
    return !at_hand;
}

// Stages samples and shadows draw the light samples of pixel sample i. Returns whether all were
// drawn.
bool Frame::draw_lights(Work& work, uint i, Progress& progress) {
    const Counting counting(device_, memory_.sampler.use);
    Stages& s = *stages_;
    const uint light_samples = schedule_.light_samples(i);
    work.pace.set_by_passes(false);
    const Sink sink = [&](const std::optional<Pass>& finished, std::size_t samples) {
        if (finished && !s.reflections) accumulate(work, i, finished);
        work.pace.set_by_passes(finished.has_value());
        device_.finish();
        work.rays += static_cast<double>(samples);
        progress.set(schedule_.progress(work.visit, work.begin_rays, work.rays));
        // A state is one between samples.
        if (is_interrupted() && !checkpoints_.are_saved()) return false;
        return work.pace.goes_on(i);
    };
    return light_samples == 0 || s.sampler->draw(work.visit.batch, schedule_.sample(i),
                                                 light_samples, s.surfaces, s.estimates, sink);
}

// Stage accumulate adds what pixel sample i has come to to the image: of all pixels, or of a pass.
void Frame::accumulate(const Work& work, uint i, const std::optional<Pass>& pass) {
    Stages& s = *stages_;
    s.accumulate.add(work.visit.batch, pass, s.surfaces, s.estimates.sums, s.seen,
                     {schedule_.weight(i), i % ERROR_GROUPS}, s.image);
}

// The image so far is the mean of each pixel's samples; groups of these say what its error is.
void Frame::keep_image() {
    Stopwatch watch(result_.render_seconds, device_);
    keep_means(stages_->image, options_.width, schedule_, result_);
    result_.shadow_rays += standing_.begin_rays;
    result_.light_samples = schedule_.light_samples(0);
    result_.later_light_samples =
        schedule_.light_samples(std::max(std::ranges::max(standing_.done), 1u) - 1);
    if (!options_.estimates_error()) return;
    result_.error =
        estimate_error(options_.width, options_.height, stages_->image.groups.download());
    layers_.keep_error(result_.error);
}

std::string Frame::name() const {
    return name_of_render(device_, scene_, camera_, options_, plan_);
}

LightSampler& Frame::sampler() const { return *stages_->sampler; }

bool Frame::is_interrupted() const { return options_.interrupted && options_.interrupted(); }

// Between two pixel samples of a batch that is on the way to `end` of them.
void Frame::save(unsigned batch, uint end) {
    checkpoints_.save(batch, end, standing_, stages_->image, stages_->sampler.get());
}

}  // namespace manylight

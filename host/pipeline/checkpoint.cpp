// SPDX-License-Identifier: MIT
#include "pipeline/checkpoint.hpp"

#include "device/kernel_sources.hpp"
#include "output/hash.hpp"
#include "pipeline/image_options.hpp"

namespace manylight {

void Checkpoints::start(const Saving& saving, const FrameState* state, Standing& standing,
                        ImageSum& image) {
    saving_ = saving;
    saved_ = Clock::now();
    if (state == nullptr) return;
    const auto spp = state->get<uint>("spp");
    if (batches_ > 1) {  // of those that are done, nothing is kept to go on
        if (options_.spp > spp)
            throw InputError(
                "--spp {}: the checkpoint's image is made in {} batches, of {} pixel samples each: "
                "it can have fewer, not more",
                options_.spp, batches_, spp);
        if (options_.spp < spp) saving_.save = nullptr;
    }
    state_ = state;
    is_resumed_ = true;
    resumed_end_ = state->get<uint>("end");
    standing.done = state->get<uint>("done", batches_);
    standing.begin_rays = state->get<std::uint64_t>("begin_rays");
    standing.primary_rays = state->get<std::uint64_t>("primary_rays");
    state->restore("sums", image.sums);
    state->restore("residuals", image.residuals);
    state->restore("weights", image.weights);
    if (options_.estimates_error()) state->restore("groups", image.groups);
}

const FrameState* Checkpoints::state_of(unsigned batch) const {
    return state_ != nullptr && state_->get<uint>("batch") == batch ? state_ : nullptr;
}

void Checkpoints::save(unsigned batch, uint end, const Standing& standing, const ImageSum& image,
                       LightSampler* sampler) {
    FrameState state;
    state.put("batch", uint{batch});
    state.put("end", end);
    state.put("spp", options_.planned_spp());
    state.put("done", std::span<const uint>(standing.done));
    state.put("begin_rays", standing.begin_rays);
    state.put("primary_rays", standing.primary_rays);
    state.put("sums", image.sums);
    state.put("residuals", image.residuals);
    state.put("weights", image.weights);
    if (options_.estimates_error()) state.put("groups", image.groups);
    if (sampler != nullptr) sampler->save(state);
    saving_.save(state);
    saved_ = Clock::now();
}

std::string name_of_render(const Device& device, const Scene& scene, const Camera& camera,
                           const RenderOptions& options, const Plan& plan) {
    ContentHash hash;
    hash.add(scene).add(std::as_bytes(std::span(&camera, 1)));
    for (const auto& [option, value] : image_options(options)) hash.add(option).add(value.dump());
    hash.add(options.jitters()).add(plan.tiles_per_batch);
    hash.add(device.info().name).add(device.info().platform).add(device.form().lanes);
    for (const auto& [file, text] : kernel_sources) hash.add(text);
    return std::string(options.sampler) + " " + hash.add(MANYLIGHT_VERSION).name();
}

}  // namespace manylight

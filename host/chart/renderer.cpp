// SPDX-License-Identifier: MIT
#include "chart/renderer.hpp"

#include <algorithm>

#include "clock.hpp"
#include "lights/lights.hpp"

namespace manylight {

Rendering Renderer::render(const Setting& setting, uint seed, Progress& progress) {
    RenderOptions options;
    options.sampler = setting.sampler;
    options.light_samples = setting.light_samples;
    options.spp = setting.spp;
    options.seed = seed;
    options.width = width_;
    options.height = height_;
    options.memory = memory_;
    options.pixel_centre = !whole_;
    options.hide_emitters = !whole_;
    const auto start = Clock::now();
    const std::map<std::string, double> before = device_.stage_seconds();
    const double compiled = device_.compile_seconds();
    Frame frame(device_, scene_, bvh_, camera_, options);
    frame.prepare();
    const double started = seconds_since(start);
    FrameResult result = frame.render(progress);
    Rendering out;
    for (const auto& [stage, after] : device_.stage_seconds()) {
        const double took = after - (before.contains(stage) ? before.at(stage) : 0);
        if (took > 0) out.stage_seconds[stage] = took;
    }
    out.image = std::move(result.image);
    out.prepare_seconds = result.prepare_seconds;
    out.render_seconds = result.render_seconds;
    out.compile_seconds = device_.compile_seconds() - compiled;
    if (whole_) {
        // What of it was compiling is the same for all: a process finds it in a cache.
        const double own = out.prepare_seconds + out.compile_seconds;
        out.start_seconds = whole_->start_seconds + std::max(started - own, 0.0);
    }
    out.primary_rays = result.primary_rays;
    out.shadow_rays = result.shadow_rays;
    return out;
}

bool Renderer::is_exact(const Sampler& sampler) const {
    return !whole_ && sampler.all_lights &&
           std::ranges::none_of(scene_.lights,
                                [](const Light& light) { return light_has(light, TRAIT_AREA); });
}

}  // namespace manylight

// SPDX-License-Identifier: MIT
// One frame: from a scene and options to an image. Reads as the list of stages.
#pragma once

#include <memory>
#include <string>

#include "output/progress.hpp"
#include "pipeline/checkpoint.hpp"
#include "pipeline/layers.hpp"
#include "pipeline/memory.hpp"
#include "pipeline/plan.hpp"
#include "pipeline/result.hpp"
#include "pipeline/schedule.hpp"
#include "samplers/table.hpp"
#include "scene/scene.hpp"

namespace manylight {

/// Renders a scene, batch by batch of its image's tiles. Keeps references to scene and BVH.
class Frame {
  public:
    /// Plans the frame (see make_plan).
    Frame(const Device& device, const Scene& scene, const WideBvh& bvh, const Camera& camera,
          const RenderOptions& options);
    Frame(const Frame&) = delete;
    Frame& operator=(const Frame&) = delete;

    [[nodiscard]] const Plan& plan() const { return plan_; }

    /// Uploads the scene and builds the kernels.
    void prepare();

    /// What was allocated on the device so far, and what was planned.
    [[nodiscard]] const FrameMemory& memory() const { return memory_; }

    /// To be called once, after prepare(). Goes on with `state` where one is given, saved by a
    /// frame of the same name(). Throws InputError for more spp than it can go on to.
    [[nodiscard]] FrameResult render(Progress& progress, const Saving& saving = {},
                                     const FrameState* state = nullptr);

    /// Names what is rendered, with everything that a pixel sample depends on but their number.
    [[nodiscard]] std::string name() const;

    /// The lights' tree, where the sampler uses one; after prepare().
    [[nodiscard]] const LightTree& tree() const { return tree_; }

    /// With what it has learned of the last batch, after render(); where there are lights.
    [[nodiscard]] LightSampler& sampler() const;

  private:
    struct Stages;
    struct Work;

    [[nodiscard]] std::size_t items() const;  // of a batch
    [[nodiscard]] static bool is_counted(const Work& work);
    [[nodiscard]] bool has_two_surfaces() const { return plan_.centres && options_.jitters(); }
    [[nodiscard]] DeviceScene upload();
    void allocate_pixels();
    void make_sampler();
    void make_tree();
    void render_round(const Round& round, Progress& progress);
    void trace_centres(const Work& work, Progress& progress);
    void begin_batch(const Work& work, const Buffer<Surface>& surfaces, Progress& progress);
    void take_samples(Work& work, Progress& progress);
    bool trace_surfaces(const Work& work, uint i);
    [[nodiscard]] bool draw_lights(Work& work, uint i, Progress& progress);
    void accumulate(const Work& work, uint i, const std::optional<Pass>& pass);
    void keep_image();
    [[nodiscard]] bool is_interrupted() const;
    void save(unsigned batch, uint end);

    Device device_;
    const Scene& scene_;
    const WideBvh& bvh_;
    Camera camera_;
    RenderOptions options_;
    const Sampler& sampler_;
    EmitterParts emitter_parts_;
    Plan plan_;
    FrameMemory memory_;
    Schedule schedule_;
    Checkpoints checkpoints_;
    Layers layers_;
    LightTree tree_;  // where the sampler uses it
    Standing standing_;
    bool has_drawn_ = false;  // and so has what to save
    std::shared_ptr<Stages> stages_;
    FrameResult result_;
};

}  // namespace manylight

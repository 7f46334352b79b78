// SPDX-License-Identifier: MIT
// One frame: from a scene and options to an image. Reads as the list of stages.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "output/image.hpp"
#include "output/progress.hpp"
#include "pipeline/clustering.hpp"
#include "scene/scene.hpp"

namespace manylight {

struct RenderOptions {
    std::string sampler = "contribution-defensive";
    uint light_samples = 4;  // per pixel sample; ignored by exhaustive
    uint spp = 4;            // pixel samples
    uint seed = 0;
    unsigned width = 512;
    unsigned height = 512;
    bool pixel_centre = false;  // all pixel samples at the pixel's centre; always with spp 1
    ClusterOptions clusters;
    std::size_t memory = 0;  // bytes on the device; 0: half of it, at most 2 GiB
    std::vector<std::string> aovs;
};

/// A layer of extra values that a frame can give.
struct Aov {
    std::string_view name;
    std::vector<std::string> channels;  // their names in the file
    bool needs_clusters;
    std::string_view summary;
};
[[nodiscard]] const std::vector<Aov>& all_aovs();

/// What a frame will take on the device.
struct Plan {
    std::size_t scene_bytes = 0;
    std::size_t image_bytes = 0;
    std::size_t batch_bytes = 0;   // of everything that is kept for a batch of tiles
    std::size_t matrix_bytes = 0;  // the contribution matrix's part of batch_bytes
    unsigned batches = 0;
    unsigned tiles_per_batch = 0;
};

/// What a frame took and gave.
struct FrameResult {
    Image image;                                      // radiance, cd/m2
    std::vector<std::pair<std::string, Image>> aovs;  // in the order of all_aovs()
    std::size_t clusters = 0;
    std::size_t primary_rays = 0;
    std::size_t shadow_rays = 0;
    double prepare_seconds = 0;  // clusters, contributions, PDFs
    double render_seconds = 0;   // the rest
};

/// A run of tiles that is rendered at a time, on the device.
class Frame {
  public:
    /// Plans the frame. Throws InputError where options or memory will not do.
    Frame(const Device& device, const Scene& scene, const WideBvh& bvh, const Camera& camera,
          const RenderOptions& options);

    [[nodiscard]] const Plan& plan() const { return plan_; }

    /// Uploads the scene and builds the kernels.
    void prepare();

    [[nodiscard]] FrameResult render(Progress& progress);

  private:
    void cluster(const Tiles& batch, const Buffer<Surface>& surfaces, Progress& progress);
    void keep_aovs(const Tiles& batch, const Buffer<Surface>& surfaces);
    void sample(const Tiles& batch, Progress& progress);
    [[nodiscard]] bool uses_clusters() const;
    [[nodiscard]] uint light_samples() const;
    [[nodiscard]] Mixture mixture() const;

    struct Stages;
    Device device_;
    const Scene& scene_;
    const WideBvh& bvh_;
    Camera camera_;
    RenderOptions options_;
    const Sampler& sampler_;
    bool jitter_;
    Plan plan_;
    std::shared_ptr<Stages> stages_;
    FrameResult result_;
};

}  // namespace manylight

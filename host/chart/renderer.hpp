// SPDX-License-Identifier: MIT
#pragma once

#include <map>
#include <optional>
#include <string>

#include "pipeline/frame.hpp"

namespace manylight {

/// How an image of a chart is made, but for its seed.
struct Setting {
    std::string sampler;
    uint light_samples = 1;  // per pixel sample; exhaustive takes all lights
    uint spp = 1;

    bool operator==(const Setting&) const = default;
};

/// Light samples of a pixel, over all its pixel samples.
[[nodiscard]] inline double drawn(const Setting& s) {
    return static_cast<double>(s.light_samples) * s.spp;
}

/// An image and what it took, seconds.
struct Rendering {
    Image image;
    double start_seconds = 0;    // loading, the BVH, the upload to the device: of whole pixels only
    double prepare_seconds = 0;  // the sampler's own: tree, clusters, contributions, PDFs
    double render_seconds = 0;   // the rest, learning included; compiling apart
    double compile_seconds = 0;
    std::map<std::string, double> stage_seconds;  // of kernels on the device
    std::size_t primary_rays = 0;
    std::size_t shadow_rays = 0;

    [[nodiscard]] double seconds() const {
        return start_seconds + prepare_seconds + render_seconds;
    }
};

/// Whole pixels, as people see them: pixel samples anywhere in the pixel, emitters shown. Their
/// time is that of the process.
struct WholePixels {
    double start_seconds = 0;  // before a frame is made
};

/// Renders one view of a scene again and again on one device: all pixel samples at the pixel's
/// centre and emitters black, or whole pixels. Keeps references to scene and BVH.
class Renderer {
  public:
    /// `memory`: see RenderOptions.
    Renderer(Device device, const Scene& scene, const WideBvh& bvh, const Camera& camera,
             unsigned width, unsigned height, std::size_t memory,
             const std::optional<WholePixels>& whole = {})
        : device_(std::move(device)),
          scene_(scene),
          bvh_(bvh),
          camera_(camera),
          width_(width),
          height_(height),
          memory_(memory),
          whole_(whole) {}

    [[nodiscard]] Rendering render(const Setting& setting, uint seed, Progress& progress);

    [[nodiscard]] const Scene& scene() const { return scene_; }
    [[nodiscard]] const Camera& camera() const { return camera_; }
    [[nodiscard]] unsigned width() const { return width_; }
    [[nodiscard]] unsigned height() const { return height_; }
    [[nodiscard]] const DeviceInfo& device() const { return device_.info(); }

    [[nodiscard]] bool is_whole() const { return whole_.has_value(); }

    /// Whether all lights together, without chance, make the image: none has an area, and pixels
    /// are seen at their centres.
    [[nodiscard]] bool is_exact(const Sampler& sampler) const;

  private:
    Device device_;
    const Scene& scene_;
    const WideBvh& bvh_;
    Camera camera_;
    unsigned width_, height_;
    std::size_t memory_;
    std::optional<WholePixels> whole_;
};

}  // namespace manylight

// SPDX-License-Identifier: MIT
// Every kernel against its scalar reference, on the same inputs.
#pragma once

#include <cmath>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "reference/samples.hpp"
#include "samplers/contribution/clustering.hpp"
#include "samplers/table.hpp"
#include "stages/gbuffer.hpp"
#include "verify/selection.hpp"

namespace manylight {

/// One stage's comparison.
struct Check {
    std::string stage;
    std::size_t items = 0;
    std::size_t telling = 0;         // items whose value is not simply 0
    std::size_t failed = 0;          // items beyond the tolerance
    std::size_t borderline = 0;      // items that rounding of the inputs decides either way
    double excused = 0;              // as many may be borderline as rounding explains, see excuse()
    double largest = 0;              // difference over tolerance, of the items that were compared
    std::string tolerance;           // in words, with its reason
    std::string first_failure = {};  // the first failed item and both values
    std::string sampler = {};        // that the stage was judged for

    /// Whether the scene says anything about the stage.
    [[nodiscard]] bool tested() const { return telling > 0 || failed > 0; }
    /// Nothing failed, and no more is borderline than rays that graze edges explain: half a percent
    /// of all items, and what is excused.
    [[nodiscard]] bool passed() const {
        return failed == 0 &&
               static_cast<double>(borderline) <= 2 + static_cast<double>(items) / 200 + excused;
    }
    /// Counts an item; `difference` beyond `tolerance` fails it. `zero`: both values are 0.
    void compare(double difference, double tolerance, const std::string& item, bool zero = false);
    void compare_exact(bool equal, const std::string& item) { compare(equal ? 0 : 2, 1, item); }
    /// Counts an item that rounding decides either way.
    void skip_borderline();
    /// Excuses an item by its number of terms that rounding decides: by the chance that some differ
    /// where three quarters of such terms do.
    void excuse(int undecided) { excused += 1 - std::pow(0.25, undecided); }
    /// Excuses items that agree, where that matters, from a part of them: `undecided` says of item
    /// i how many of its terms rounding decides.
    void excuse_agreeing(std::size_t agreeing, const std::function<int(std::size_t)>& undecided);
};

/// "samples" of "samples (ris)": the stage's name in all rooms.
[[nodiscard]] std::string stage_of(const Check& check);

struct VerifyOptions {
    unsigned width = 96;
    unsigned height = 96;
    uint seed = 1;
    ClusterOptions clusters;
    std::size_t most_entries = 40'000;  // of a stage that the reference evaluates
    // Points are no pixels to the stages that light them: their light goes in directions drawn at
    // random, with throughputs drawn at random.
    bool receivers = false;
    Selection only;
};

/// A scene on a device and in the reference: what checks of stages share (see stages.hpp). The
/// scene's lights are complete.
class Verifier {
  public:
    Verifier(Device device, const Scene& scene, const Camera& camera, const VerifyOptions& options);

    /// The checks of all stages that the options select.
    [[nodiscard]] std::vector<Check> all();

    [[nodiscard]] Device& device() { return device_; }
    [[nodiscard]] const Scene& scene() const { return scene_; }
    [[nodiscard]] const std::vector<Light>& lights() const { return scene_.lights; }
    [[nodiscard]] const reference::Viewers& viewers() const { return view_; }
    [[nodiscard]] const VerifyOptions& options() const { return options_; }
    [[nodiscard]] const Tiles& tiles() const { return tiles_; }
    [[nodiscard]] const LightTree& tree() const { return tree_; }
    [[nodiscard]] const reference::Tracer& tracer() const { return tracer_; }
    /// Surfaces at the pixels' centres, [item] of tiles().
    [[nodiscard]] const Buffer<Surface>& surfaces() const { return surfaces_; }
    [[nodiscard]] const std::vector<Surface>& found_surfaces() const { return found_; }
    /// The scene on the device, as the sampler needs it: with the lights in the tree's order or
    /// the scene's.
    [[nodiscard]] const DeviceScene& device_scene(const Sampler& sampler) const {
        return sampler.tree ? tree_scene_ : device_scene_;
    }

    [[nodiscard]] const DeviceScene& device_scene() const { return device_scene_; }
    [[nodiscard]] const DeviceScene& tree_scene() const { return tree_scene_; }
    [[nodiscard]] const Camera& camera() const { return camera_; }
    /// The largest coordinate that a ray may meet, m.
    [[nodiscard]] float reach() const { return reach_; }
    /// Of the pixels' centres; not built where there is no light.
    [[nodiscard]] const Clustering& clustering() const { return clustering_; }
    /// Its contributions, [region][light], as they were before they became a PDF.
    [[nodiscard]] const std::vector<float>& matrix() const { return matrix_; }

    /// Surfaces beside surfaces(); where the scene varies materials, the last ones' are in scene().
    [[nodiscard]] Buffer<Surface> trace(const Tiles& tiles, const PixelSample& sample);
    /// The same for a check that traces by itself: where in `materials` its points' are (see
    /// GBufferStage), and what takes them into scene() afterwards.
    [[nodiscard]] std::size_t points() const { return points_; }
    void keep_materials();
    /// Where the light of a batch's points is to go, for what is launched and judged next.
    void send_out(const std::vector<Surface>& points);

  private:
    Device device_;
    std::optional<Scene> varied_;  // a copy that is changed, where the scene needs one
    const Scene& scene_;
    Camera camera_;
    reference::Viewers view_;  // of the points that are lit
    VerifyOptions options_;
    Tiles tiles_;  // those in the image's middle, as many as the matrix may have
    float reach_;
    WideBvh bvh_;
    std::size_t points_;         // that surfaces_ have at most, and those beside them
    Buffer<Outgoing> outgoing_;  // of receivers
    DeviceScene device_scene_;
    LightTree tree_;
    DeviceScene tree_scene_;  // with the lights in the tree's order
    reference::Tracer tracer_;
    Buffer<Surface> surfaces_;    // at the pixels' centres
    std::vector<Surface> found_;  // the same, on the host
    Clustering clustering_;
    std::vector<float> matrix_;  // downloaded before it became a PDF
};

}  // namespace manylight

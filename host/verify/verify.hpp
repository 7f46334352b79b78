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

struct VerifyOptions {
    unsigned width = 96;
    unsigned height = 96;
    uint seed = 1;
    ClusterOptions clusters;
    std::size_t most_entries = 40'000;  // of a stage that the reference evaluates
    // Points are no pixels to the stages that light them: their light goes in directions drawn at
    // random, with throughputs drawn at random.
    bool receivers = false;
};

/// Runs the stages on a device and judges each by the reference. The scene's lights are complete.
class Verifier {
  public:
    Verifier(Device device, const Scene& scene, const Camera& camera, const VerifyOptions& options);

    [[nodiscard]] Check layout();
    [[nodiscard]] Check random();
    [[nodiscard]] Check gbuffer(bool jitter);
    [[nodiscard]] Check clusters();
    [[nodiscard]] Check representatives();
    [[nodiscard]] Check contributions();
    [[nodiscard]] Check refinement();
    /// CDFs of rows that are mixed by `shares`: of the contribution matrix where `clustered`, else
    /// one row by power.
    [[nodiscard]] Check pdf(std::string_view sampler, const Shares& shares, bool clustered);
    [[nodiscard]] Check samples(const Sampler& sampler);
    /// Which cells of area lights points of the scene's emissive triangles are on.
    [[nodiscard]] Check cells();
    /// Beside the light samples of a sampler whose row has a closed form, or of no sampler.
    [[nodiscard]] Check reflections(const Sampler* sampler = nullptr);
    /// Beside no sampler, and beside each that has one.
    [[nodiscard]] std::vector<Check> all_reflections();
    [[nodiscard]] Check accumulate();

    [[nodiscard]] Check seen_lights();

    /// Sampler adaptive with cuts of `cut_size` nodes at most: cuts, visibility, weights, samples.
    [[nodiscard]] std::vector<Check> adaptive(uint cut_size);

    // What a sampler's own checks need.
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

    /// Those of every sampler in the table, and reflections beside them.
    [[nodiscard]] std::vector<Check> lighting();

    /// All of them.
    [[nodiscard]] std::vector<Check> all();

  private:
    [[nodiscard]] Tiles tiles_to_sample(uint light_samples) const;
    void accumulate(Check& check, bool grouped, bool by_passes);
    void check_surface(Check& check, const Surface& found, uint x, uint y, bool jitter);
    void check_offset(Check& check, const Surface& found, const reference::Ray& ray,
                      const reference::Hit& hit, double shift, const std::string& where);
    void check_material(Check& check, const Surface& found, const reference::Ray& ray,
                        const reference::Hit& hit, double shift, const std::string& where);
    // Surfaces beside surfaces_; where the scene varies materials, the last ones' are in scene_.
    [[nodiscard]] Buffer<Surface> trace(const Tiles& tiles, const PixelSample& sample);
    void keep_materials();
    // Where the light of a batch's points is to go, for what is launched and judged next.
    void send_out(const std::vector<Surface>& points);

    Device device_;
    std::optional<Scene> varied_;  // a copy that is changed, where the scene needs one
    const Scene& scene_;
    Camera camera_;
    reference::Viewers view_;  // of the points that are lit
    Buffer<Outgoing> outgoing_;
    VerifyOptions options_;
    Tiles tiles_;  // those in the image's middle, as many as the matrix may have
    float reach_;
    WideBvh bvh_;
    std::size_t points_;  // that surfaces_ have at most, and those beside them
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

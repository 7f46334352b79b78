// SPDX-License-Identifier: MIT
// Stage samples: what a sampler is to its scalar references, one file each in samplers/.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "reference/shading.hpp"

namespace manylight::reference {

/// A surface point whose lights are drawn.
struct Point {
    const Scene& scene;
    Viewer viewer;
    const Surface& surface;
    [[nodiscard]] const Material& material() const { return scene.materials[surface.shading]; }
};

/// What is asked of a sampler at a point.
struct PixelDraws {
    std::size_t item;  // of the batch
    uint pixel, pixel_sample, seed;
    uint sample_count;  // light samples
    bool judge;         // fill an estimate's slack and borderline (slow)
};

/// One pixel sample's estimate and what rounding may do to it.
struct Estimate {
    glm::dvec3 value{0};      // cd/m2
    glm::dvec3 magnitude{0};  // sum of the terms' absolute values
    double slack = 0;         // of rounding, where asked for
    double borderline = 0;    // sum of the terms whose visibility rounding decides, where asked for
    int undecided = 0;        // number of terms that rounding decides, where asked for
    bool uncertain = false;   // rounding may have drawn other lights
};

/// The scalar reference of a sampler whose pixels do not depend on each other's draws.
class Sampler {
  public:
    Sampler() = default;
    Sampler(const Sampler&) = delete;
    Sampler& operator=(const Sampler&) = delete;
    virtual ~Sampler() = default;

    /// Stage samples for one item.
    [[nodiscard]] virtual Estimate estimate(const Tracer& tracer, const Point& point,
                                            const PixelDraws& draws) const = 0;
};

/// Which light sample is to be drawn, from 128 random bits.
struct Draw {
    std::size_t item;
    uint sample, sample_count;
    std::array<uint, 4> bits;  // 1 and 2 are the point on a light with area
    uint light_count;
    bool judge = false;  // fill the choice's slack (slow)
};

/// A light sample: which light, and 1 / (N p) of paper eq. (2); weight 0: none.
struct Choice {
    uint light;
    double weight;
    bool borderline = false;  // rounding may have drawn another light
    double slack = 0;         // what rounding may do to the weight, relative; where asked for
};

/// How many light samples are expected on a light.
struct ExpectedCount {
    struct Round {
        double part;   // of all light samples that are drawn in it
        double count;  // of those on the light, were all drawn as these are
    };
    std::vector<Round> rounds;
    bool doubtful = false;  // rounding may have drawn them in another way
};

/// A sampler that draws lights one at a time.
class OneLight : public Sampler {
  public:
    [[nodiscard]] virtual Choice choose(const Point& point, const Draw& draw) const = 0;

    /// The probability that one draw at a point of a batch's item is of a light of the scene; none
    /// where it has no closed form.
    [[nodiscard]] virtual std::optional<double> probability(const Point& /*point*/,
                                                            std::size_t /*item*/,
                                                            uint /*light*/) const {
        return {};
    }

    /// How many of a pixel sample's light samples are expected on a light; none where there is no
    /// closed form.
    [[nodiscard]] virtual std::optional<ExpectedCount> expected_count(const Point& point,
                                                                      std::size_t item, uint light,
                                                                      uint sample_count) const;

    [[nodiscard]] Estimate estimate(const Tracer& tracer, const Point& point,
                                    const PixelDraws& draws) const override;
};

/// (sample + random / 2^32) / count of `total`: an integer below it, stratified over the samples.
[[nodiscard]] uint stratified(uint total, uint sample, uint count, uint random);

/// A light by its running sum, and its part of the whole.
struct Found {
    uint light;
    uint width;
};

/// The light at `target`, which is below the last, of running sums by light.
[[nodiscard]] Found search(std::span<const uint> cdf, uint target);

/// A draw from running sums by light.
[[nodiscard]] Choice draw_from(std::span<const uint> cdf, const Draw& draw);

/// The probability of a light by running sums.
[[nodiscard]] double share_of(std::span<const uint> cdf, uint light);

/// A difference in a decision that single precision may not see.
constexpr double doubtful_draw = 1e-5;

}  // namespace manylight::reference

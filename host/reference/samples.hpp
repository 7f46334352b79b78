// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <span>

#include "light_tree/light_tree.hpp"
#include "reference/shading.hpp"
#include "shared/tiles.h"

namespace manylight::reference {

/// What a sampler may draw from; a sampler uses what it needs.
struct Tables {
    std::span<const uint> power_cdf;  // [light]
    std::span<const uint> cdf;        // [row * light_count + light]
    std::span<const uint> item_rows;  // [item]
    const LightTree* tree = nullptr;
};

/// A light sample: which light, and 1 / (N p) of paper eq. (2); weight 0: none.
struct Choice {
    uint light;
    double weight;
    bool borderline = false;  // rounding may have drawn another light
    double slack = 0;         // what rounding may do to the weight, relative; where asked for
};

/// A surface point whose lights are drawn.
struct Point {
    const Scene& scene;
    const Camera& camera;
    const Surface& surface;
    [[nodiscard]] const Material& material() const { return scene.materials[surface.shading]; }
};

/// Which light sample is to be drawn, from 128 random bits.
struct Draw {
    std::size_t item;
    uint sample, sample_count;
    std::array<uint, 4> bits;  // 1 and 2 are the point on a light with area
    uint light_count;
    bool judge = false;  // fill the choice's slack (slow)
};

using ChooseLight = Choice (*)(const Tables& tables, const Point& point, const Draw& draw);

[[nodiscard]] Choice choose_exhaustive(const Tables&, const Point&, const Draw&);
[[nodiscard]] Choice choose_uniform(const Tables&, const Point&, const Draw&);
[[nodiscard]] Choice choose_power(const Tables&, const Point&, const Draw&);
[[nodiscard]] Choice choose_contribution(const Tables&, const Point&, const Draw&);
[[nodiscard]] Choice choose_ris(const Tables&, const Point&, const Draw&);
[[nodiscard]] Choice choose_lighttree(const Tables&, const Point&, const Draw&);

/// The probability that one draw at a point of a batch's item is of a light of the scene.
using LightProbability = double (*)(const Tables& tables, const Point& point, std::size_t item,
                                    uint light);

[[nodiscard]] double probability_uniform(const Tables&, const Point&, std::size_t, uint);
[[nodiscard]] double probability_power(const Tables&, const Point&, std::size_t, uint);
[[nodiscard]] double probability_contribution(const Tables&, const Point&, std::size_t, uint);
[[nodiscard]] double probability_lighttree(const Tables&, const Point&, std::size_t, uint);

/// One pixel sample's estimate and what rounding may do to it.
struct Estimate {
    glm::dvec3 value{0};      // cd/m2
    glm::dvec3 magnitude{0};  // sum of the terms' absolute values
    double slack = 0;         // of rounding, where asked for
    double borderline = 0;    // sum of the terms whose visibility rounding decides, where asked for
    int undecided = 0;        // number of terms that rounding decides, where asked for
    bool uncertain = false;   // rounding may have drawn other lights
};

/// Stage samples for one item; `judge`: fill slack and borderline (slow).
[[nodiscard]] Estimate estimate(const Scene& scene, const Tracer& tracer, const Camera& camera,
                                const Surface& surface, const Tables& tables, ChooseLight choose,
                                std::size_t item, uint pixel, uint pixel_sample, uint seed,
                                uint sample_count, bool judge);

}  // namespace manylight::reference

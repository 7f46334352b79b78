// SPDX-License-Identifier: MIT
// Which lights make an image: an estimate that does not depend on the sampler that rendered it.
#pragma once

#include <string>
#include <vector>

#include "scene/scene.hpp"

namespace manylight {

/// A light's part in an image.
struct TopLight {
    std::size_t light;      // in Scene::lights
    double share;           // of the luminance that the image's surfaces reflect
    double standard_error;  // of the share
    double seen;            // share of the image's points that it lights
};

struct TopLights {
    std::vector<TopLight> lights;  // by share
    unsigned points = 0;           // of the image
    unsigned light_samples = 0;    // at each, for the total; 0: all lights were evaluated
    std::size_t shadow_rays = 0;
    double luminance = 0;  // that all lights together give, mean over the image, cd/m2
};

/// The `count` lights that give an image most, estimated by the scalar reference. At one random
/// point of each of up to 4096 equal rectangles of the image, 16 lights are drawn from the light
/// tree as sampler lighttree draws them, which gives the total and 2 x count candidates, without
/// bias. The candidates are then evaluated at all points. Where lights are no more than candidates,
/// all are evaluated and none is drawn. Standard errors take the points for independent, and so are
/// too large rather than too small.
[[nodiscard]] TopLights find_top_lights(const Scene& scene, const Camera& camera, unsigned width,
                                        unsigned height, unsigned count, unsigned seed);

/// The likely reason why an image is black, by the scalar reference at some of its points: "no
/// geometry is in view". `hides_emitters`: see RenderOptions.
[[nodiscard]] std::string why_black(const Scene& scene, const Camera& camera, unsigned width,
                                    unsigned height, bool hides_emitters);

}  // namespace manylight

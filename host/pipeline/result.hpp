// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "output/error_estimate.hpp"
#include "output/image.hpp"
#include "pipeline/schedule.hpp"
#include "stages/accumulate.hpp"

namespace manylight {

/// What a frame took and gave.
struct FrameResult {
    Image image;                                      // radiance, cd/m2
    std::vector<std::pair<std::string, Image>> aovs;  // in the order of all_aovs()
    std::size_t clusters = 0;
    std::size_t primary_rays = 0;
    bool is_resumed = false;  // rays count from the first run's start, stages' seconds do not
    std::size_t shadow_rays = 0;
    uint light_samples = 0;              // of the first pixel sample
    uint later_light_samples = 0;        // of the last one
    double spp = 0;                      // pixel samples, on average where they were cut short
    std::size_t empty_pixels = 0;        // without one
    bool is_cut_short = false;           // some pixels have fewer samples than others, or all
                                         // have fewer than was asked for: by time, an interrupt
    std::optional<ErrorEstimate> error;  // where it was asked for and can be made
    double prepare_seconds = 0;          // clusters, contributions, PDFs; compiling apart
    double render_seconds = 0;           // the rest, likewise
};

/// Keeps the image so far, the mean of each pixel's samples, and how many these and their rays are.
/// `width`, in pixels, is the image's.
void keep_means(const ImageSum& sum, unsigned width, const Schedule& schedule, FrameResult& result);

}  // namespace manylight

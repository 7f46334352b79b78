// SPDX-License-Identifier: MIT
// Renders a scene with several samplers over a ladder of settings and seeds, and judges each image.
#pragma once

#include "chart/reference.hpp"
#include "output/metrics.hpp"

namespace manylight {

struct ChartOptions {
    std::vector<std::string> samplers;  // names of the table
    std::vector<uint> light_samples = {1, 4, 16, 64};
    std::vector<uint> spp = {1, 4};
    uint seeds = 5;
    uint seed = 1;                 // the first one
    std::string baseline;          // the sampler that others are compared with
    double most_seconds = 20;      // of one setting, over its seeds
    double reference_seconds = 0;  // to spend on the reference, at most; 0: as long as it takes
    std::string cache;             // folder for references; empty: the user's
    bool whole = false;            // whole pixels, see WholePixels
    bool quiet = false;
};

/// One image and what it is worth.
struct Run {
    Setting setting;
    uint seed = 0;
    Rendering rendering;    // without the image
    Difference difference;  // without its pixels
    double luminance = 0;   // mean, cd/m2
};

/// The image of a setting's first seed.
struct KeptImage {
    Setting setting;
    PackedImage packed;
};

/// A sampler, or one of its settings, that is not measured, with the reason.
struct LeftOut {
    Setting setting;
    std::string reason;
};

struct Chart {
    ChartOptions options;
    std::vector<Setting> settings;  // measured, sampler by sampler
    std::vector<LeftOut> left_out;
    std::vector<Run> runs;  // in the order of time
    std::vector<KeptImage> images;
    std::map<std::string, double> compile_seconds;  // by sampler
    Reference reference;
    Setting reference_setting;      // of each of its images
    std::string reference_file;     // in the cache
    std::size_t cached_images = 0;  // that the cache had
    double smallest_error = 0;      // relMSE that the reference had to judge
};

/// The reference's error is to be this much smaller than what it judges.
constexpr double reference_ratio = 100;

/// The ladder of a sampler, from the cheapest setting to the dearest one. One that takes all lights
/// has one number of light samples, and where it is exact, one image.
[[nodiscard]] std::vector<Setting> ladder_of(const Sampler& sampler, const ChartOptions& options,
                                             const Renderer& renderer);

/// Does all of it. Throws InputError, RuntimeError.
[[nodiscard]] Chart measure_chart(Renderer& renderer, const ChartOptions& options);

}  // namespace manylight

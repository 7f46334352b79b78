// SPDX-License-Identifier: MIT
#pragma once

#include <nlohmann/json.hpp>

#include "chart/summary.hpp"

namespace manylight {

/// An image that the report shows.
struct ShownImage {
    const KeptImage* image;
    bool equal_samples = false;  // shown at the baseline's numbers of samples
    bool equal_time = false;     // shown for being as fast as the baseline, as nearly as there is
    std::string file;            // of its errors, in the chart's folder
};

/// Of each sampler, the image at the middle of the baseline's ladder, and that of the time nearest
/// to the baseline's there.
[[nodiscard]] std::vector<ShownImage> choose_images(const Chart& chart,
                                                    const std::vector<SettingSummary>& summaries);

/// What of a chart its runs do not say.
struct ChartFacts {
    nlohmann::json scene;    // file, camera, triangles, lights, emitter_points
    nlohmann::json seconds;  // load, bvh
    std::string command;     // that makes the chart again
    std::string view;        // options of manylight render for the same view
};

/// chart.json: see docs/chart.md.
[[nodiscard]] nlohmann::json chart_json(const Chart& chart, const Renderer& renderer,
                                        const std::vector<SettingSummary>& summaries,
                                        const std::vector<ShownImage>& images,
                                        const ChartFacts& facts);

}  // namespace manylight

// SPDX-License-Identifier: MIT
#pragma once

#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string_view>

#include "chart/chart_json.hpp"

namespace manylight {

/// Every file below host/chart/report/, and the plotting library as library.js, by its path; made
/// by cmake/embed.cmake.
extern const std::map<std::string_view, std::string_view> report_sources;

/// report.html: one page that holds everything it shows. `chart`: chart.json.
[[nodiscard]] std::string make_report(const nlohmann::json& chart, const Image& reference,
                                      const std::vector<ShownImage>& images);

/// Bytes of all images in a report, at most: more are shown smaller.
constexpr std::size_t most_image_bytes = 12'000'000;

}  // namespace manylight

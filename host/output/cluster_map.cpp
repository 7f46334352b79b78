// SPDX-License-Identifier: MIT
#include "output/cluster_map.hpp"

#include <algorithm>
#include <cmath>

namespace manylight {
namespace {

const Image& layer(const std::vector<std::pair<std::string, Image>>& layers,
                   std::string_view name) {
    return std::ranges::find(layers, name, &std::pair<std::string, Image>::first)->second;
}

// A hue per cluster: neighbours' numbers are close, so steps of the golden angle tell them apart.
glm::vec3 tint(float cluster) {
    const float hue = std::fmod(cluster * 0.618034f, 1.0f) * 6;
    const auto channel = [hue](float centre) {
        const float distance = std::abs(std::remainder(hue - centre, 6.0f));
        return std::clamp(2 - distance, 0.0f, 1.0f);
    };
    return {channel(0), channel(2), channel(4)};
}

}  // namespace

Image draw_cluster_map(const Image& image, float exposure,
                       const std::vector<std::pair<std::string, Image>>& layers) {
    const Image& clusters = layer(layers, "cluster");
    const Image& representatives = layer(layers, "representative");
    Image out(image.width, image.height, {"R", "G", "B"});
    for (unsigned y = 0; y < image.height; ++y)
        for (unsigned x = 0; x < image.width; ++x) {
            const float* rgb = image.at(x, y);
            const float grey = std::clamp(
                exposure * (0.2126f * rgb[0] + 0.7152f * rgb[1] + 0.0722f * rgb[2]), 0.0f, 1.0f);
            const float cluster = *clusters.at(x, y);
            const bool edge = (x > 0 && *clusters.at(x - 1, y) != cluster) ||
                              (y > 0 && *clusters.at(x, y - 1) != cluster);
            const glm::vec3 color = (0.1f + 0.5f * grey) * (0.6f + 0.4f * tint(cluster));
            for (int c = 0; c < 3; ++c) out.at(x, y)[c] = color[c] * (edge ? 0.35f : 1.0f);
            if (*representatives.at(x, y) == 0) continue;
            for (int c = 0; c < 3; ++c) out.at(x, y)[c] = c == 0 ? 1.0f : 0.02f;
        }
    return out;
}

}  // namespace manylight

// SPDX-License-Identifier: MIT
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "output/image.hpp"
#include "samplers/sampler.hpp"

namespace manylight {

/// What a batch of tiles knows of its pixels, on the host.
struct BatchFacts {
    glm::dvec3 origin;                 // Scene::origin
    std::vector<Material> materials;   // by Surface::shading
    std::vector<Surface> surfaces;     // [item], at the pixels' centres
    ClusterFacts clusters;             // empty where nothing was clustered, as below
    std::vector<std::size_t> numbers;  // [region] number of the leaf in the whole image
};

/// A layer of extra values that a frame can give.
struct Aov {
    std::string_view name;
    std::vector<std::string> channels;  // their names in the file
    bool needs_clusters;
    std::string_view summary;
    // None for what is known of the whole image at its end only.
    void (*fill)(const BatchFacts& facts, std::size_t item, float* out);
};
[[nodiscard]] const std::vector<Aov>& all_aovs();

/// Writes a batch's pixels into a layer of the whole image.
void fill_layer(const Aov& aov, const BatchFacts& facts, const Tiles& batch, Image& layer);

}  // namespace manylight

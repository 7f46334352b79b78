// SPDX-License-Identifier: MIT
#include "pipeline/result.hpp"

#include <algorithm>

namespace manylight {

void keep_means(const ImageSum& sum, unsigned width, const Schedule& schedule,
                FrameResult& result) {
    const std::vector<float4> sums = sum.sums.download();
    const std::vector<float> weights = sum.weights.download();
    result.image = Image(width, static_cast<unsigned>(sums.size() / width), {"R", "G", "B"});
    result.empty_pixels = static_cast<std::size_t>(std::ranges::count(weights, 0.f));
    const auto first_weight = static_cast<float>(RenderOptions::first_samples);
    const float later_weight = schedule.weight(RenderOptions::first_samples);
    double rays = 0;
    double samples = 0;
    for (std::size_t i = 0; i < sums.size(); ++i) {
        for (int c = 0; c < 3; ++c)
            result.image.values[3 * i + c] = sums[i][c] / std::max(weights[i], 1e-30f);
        rays += sums[i].w;
        samples += std::min(weights[i], first_weight) +
                   std::max(weights[i] - first_weight, 0.f) / later_weight;
    }
    result.shadow_rays = static_cast<std::size_t>(rays);
    result.spp = samples / static_cast<double>(sums.size());
}

}  // namespace manylight

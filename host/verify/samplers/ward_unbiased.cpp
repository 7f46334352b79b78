// SPDX-License-Identifier: MIT
#include "reference/samplers/ward.hpp"
#include "samplers/ward/ward.hpp"
#include "verify/sampler_checks.hpp"

namespace manylight {

// Its histories and its walk are sampler ward's.
SamplerChecks checks_ward_unbiased() {
    return {
        .reference = [](const LightSampler& sampler,
                        const CheckContext& /*context*/) -> std::unique_ptr<reference::Sampler> {
            const auto& ward = dynamic_cast<const Ward&>(sampler);
            const std::size_t side = ward.tiles().size;
            return std::make_unique<reference::Ward>(
                reference::WardOptions{.tau = ward.tau(),
                                       .certainty = ward.certainty(),
                                       .draws_tail = true,
                                       .tile_pixels = side * side,
                                       .histories = ward.histories()});
        },
        .run = check_samples};
}

}  // namespace manylight

// SPDX-License-Identifier: MIT
#include "reference/samplers/octree.hpp"

#include "samplers/octree/octree.hpp"
#include "verify/sampler_checks.hpp"

namespace manylight {
namespace {

std::unique_ptr<reference::Sampler> octree_reference(const LightSampler& sampler,
                                                     const CheckContext& /*context*/) {
    const auto& octree = dynamic_cast<const Octree&>(sampler);
    return std::make_unique<reference::Octree>(octree.nodes(), octree.epsilon(),
                                               octree.to_virtual());
}

}  // namespace

// The probability of a light depends on the pixel's cut and is not that of a single draw: no closed
// form. Its estimates are judged draw by draw instead.
SamplerChecks checks_octree() { return {.reference = octree_reference, .run = check_samples}; }

SamplerChecks checks_octree_virtual() { return checks_octree(); }

}  // namespace manylight

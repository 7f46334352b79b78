// SPDX-License-Identifier: MIT
// What judges a sampler: one row for each of the table.
#pragma once

#include <memory>
#include <vector>

#include "samplers/one_light/one_light.hpp"
#include "samplers/table.hpp"
#include "verify/verify.hpp"

namespace manylight {

/// What a reference may need beside what the sampler itself has.
struct CheckContext {
    const Scene& scene;
    const LightTree& tree;
};

struct SamplerChecks {
    /// Of a sampler whose pixels do not depend on each other's draws: the scalar reference, which
    /// draws from what the sampler, after prepare() and begin(), has made. Keeps references to the
    /// context's.
    std::unique_ptr<reference::Sampler> (*reference)(const LightSampler& sampler,
                                                     const CheckContext& context) = nullptr;
    /// All checks that the sampler has, stage by stage.
    std::vector<Check> (*run)(Verifier& verifier, const Sampler& sampler) = nullptr;
};

/// The row of a sampler of the table.
[[nodiscard]] const SamplerChecks& checks_of(const Sampler& sampler);

/// The buffers that a sampler draws from, of one that draws lights one at a time.
[[nodiscard]] const Arguments& tables_of(const LightSampler& sampler);

/// For `run`: stage samples alone.
[[nodiscard]] std::vector<Check> check_samples(Verifier& verifier, const Sampler& sampler);

}  // namespace manylight
